"""The contents of panels as plain data: rows, texts, trees and positions."""

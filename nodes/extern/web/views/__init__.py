"""What the panels of the page show, as plain data: rows, texts, trees and positions."""

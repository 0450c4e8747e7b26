"""What cameras and files give: frames and clouds."""

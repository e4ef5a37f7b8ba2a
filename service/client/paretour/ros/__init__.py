"""What goes from robots of ROS to the service, and from it to them: maps, and paths."""

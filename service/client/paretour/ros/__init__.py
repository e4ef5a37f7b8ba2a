"""Read maps of ROS as requests, and write paths for robots of ROS."""

"""The map of a request: pictures, occupancy grids of ROS, and robots that share a map."""

"""Maps in requests: pictures, occupancy grids of ROS, and the fields that say how to read them."""

"""Read maps as requests: pictures, maps of ROS and of MovingAI, and the costs of their cells."""

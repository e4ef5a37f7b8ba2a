"""Read files that people have (CSV, XLSX, GeoJSON, TSPLIB, VROOM, ROS) as requests."""

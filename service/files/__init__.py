"""Read files that people have (CSV, XLSX, GeoJSON, GPX, KML, TSPLIB, VROOM, ROS) as requests."""

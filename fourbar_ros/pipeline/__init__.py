"""One sample after another, without ROS: shared by the node and the recomputation of bags."""

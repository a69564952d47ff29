"""Bags in the layout of rosbag2: written with the mcap library alone, read without ROS."""

"""The only modules that know ROS."""

"""The ROS door: a server for ROS-Industrial's simple_message protocol, on the side of the robot controller.
MoveIt moves the robot through it, with ROS-Industrial's unchanged client nodes.
"""

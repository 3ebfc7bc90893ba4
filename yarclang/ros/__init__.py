"""The ROS door: the controller's side of ROS-Industrial's simple_message protocol, by which MoveIt moves the
robot through the stock client nodes.
"""

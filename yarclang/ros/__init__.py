"""The ROS door: the controller's side of ROS-Industrial's simple_message, with which MoveIt moves a robot
through the stock client nodes.
"""

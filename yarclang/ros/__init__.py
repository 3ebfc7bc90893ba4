"""The ROS door: the controller's side of ROS-Industrial's simple_message, so that MoveIt moves a robot through the stock client nodes."""

"""What is measured with the arm itself: a tool's tip, a frame, where the joints' zeros are. Arithmetic only; nothing here moves."""

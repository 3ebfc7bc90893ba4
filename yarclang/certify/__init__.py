"""The judge: reads the emitted controller text back and proves what the robot will do."""

from yarclang.certify.certificate import Certificate, CommandCertificate, Load
from yarclang.certify.certifying import certify

__all__ = ["Certificate", "CommandCertificate", "Load", "certify"]

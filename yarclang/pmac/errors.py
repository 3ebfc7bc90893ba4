"""Error numbers of the controller and their meanings.

Sources: for 1 to 19, PSRM 25 and the tables of public clients; for 20 to 22, one client.
"""

BUSY_PROGRAM = 1
DATA = 3
NEEDS_BUFFER = 5
NO_ROOM = 6
BUFFER_IN_USE = 7
STRUCTURE = 9
BOTH_LIMITS = 10
MOVE_IN_PROGRESS = 11
OPEN_LOOP = 12
NOT_ACTIVATED = 13
NO_MOTORS = 14
NO_PROGRAM = 15
BAD_PROGRAM = 16
MOVED_AWAY = 17

ERRORS: dict[int, str] = {
    BUSY_PROGRAM: "not allowed while a motion program runs",
    2: "password error",
    DATA: "data error, or unknown command",
    4: "illegal character, or parity error",
    NEEDS_BUFFER: "not allowed unless a buffer is open",
    NO_ROOM: "no room in the buffer",
    BUFFER_IN_USE: "a buffer is already in use",
    8: "MACRO auxiliary communications error",
    STRUCTURE: "program structure error, such as ENDIF without IF",
    BOTH_LIMITS: "both overtravel limits of a motor are set",
    MOVE_IN_PROGRESS: "the previous move isn't completed",
    OPEN_LOOP: "a motor is open-loop",
    NOT_ACTIVATED: "a motor isn't activated",
    NO_MOTORS: "no motors in the coordinate system",
    NO_PROGRAM: "not pointing to a valid program",
    BAD_PROGRAM: "running a badly structured program",
    MOVED_AWAY: "resume after H or Q with motors moved away",
    18: "phase reference during a move, or phase clock error",
    19: "a command that changes position with moves in CCBUFFER",
    20: "FSAVE with an incompatible flash",
    21: "FSAVE while clearing a flash sector",
    22: "FREAD with a bad flash",
}

"""Findings of family 04: values."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0401",
        "wrong-number-of-values",
        "error",
        "values are missing or surplus",
        "A joint position has one value for each joint; a pose has x y z and an orientation.",
        "P0010 MOVEJ 0 0 0 0 30 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0402",
        "not-a-number",
        "error",
        "this is not a number",
        "A number is an optional sign, digits with an optional decimal point, and an optional exponent, "
        "with blanks between numbers. `30-5` may mean two values, and `0,5` may mean 0.5: neither is "
        "guessed.",
        "P0010 MOVEJ 0 0 0 0 30-5 0 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 -5 [5] (deg,s)",
    ),
    Finding(
        "Y0403",
        "number-too-large",
        "error",
        "a number is too large",
        "Values beyond 1e9 are refused: no robot has such a joint position or such a workspace.",
        "P0010 MOVEJ 0 0 0 0 1e999 0 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 10 0 [5] (deg,s)",
    ),
    Finding(
        "Y0404",
        "quaternion-norm",
        "error",
        "the quaternion's norm isn't 1",
        "qx qy qz qw of an orientation have the norm 1. A norm that is off by more than 0.001 means that a "
        "value is missing, mistyped or in the wrong order.",
        "P0010 MOVEJ_QUAT {TCP} 0 1174.4 1176 0 0 0 2 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_QUAT {TCP} 0 1174.4 1176 0 0 0 1 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0405",
        "wrong-number-of-way-points",
        "error",
        "way-points are missing or surplus",
        "MOVEJ and MOVEL go to one way-point, a spline runs through two or more, separated by semicolons.",
        "P0010 MOVEJ 0 0 0 0 0 0; 0 0 0 0 30 0 [5] (deg,s)",
        "P0010 MOVEJ_SPLINE 0 0 0 0 10 0; 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0406",
        "missing-time",
        "error",
        "the motion time is missing",
        "The speed of the arm is never guessed: `[20]` is the duration of the whole motion, `[MIN]` the "
        "shortest that the limits allow.",
        "P0010 MOVEJ 0 0 0 0 30 0 (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [MIN] (deg,s)",
        needs="default",
    ),
    Finding(
        "Y0407",
        "bad-time",
        "error",
        "this is no motion time",
        "A motion time is a positive number with a unit of time, MIN, a share of the limits ([50%]), or a "
        "speed: [V 250] for Cartesian motions, [V<=250] for all motions.",
        "P0010 MOVEJ 0 0 0 0 30 0 [-5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0408",
        "surplus-part",
        "error",
        "the command doesn't take this part",
        "A part that a command doesn't use suggests that another command was meant.",
        "P0010 STOP [5] (s)",
        "P0010 STOP",
    ),
    Finding(
        "Y0409",
        "half-turn",
        "error",
        "a turn by half a revolution has no short way",
        "A straight motion turns about one axis, the short way. At half a turn both ways are equally "
        "long, and beyond half a turn the other way is the short one. A via pose shows which way is "
        "meant.",
        "P0010 DMOVE {TCP} 0 0 0 0 180 0 [5] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 0 0 0 90 0 [5] (mm,deg,s) {B}\n"
        "P0020 DMOVE {TCP} 0 0 0 0 90 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0410",
        "not-computable",
        "error",
        "the expression has no value",
        "The expression divides by zero, takes the root of a negative number, or overflows.",
        "LET COUNT = 0\nLET PITCH = 60 / COUNT\nP0010 STOP",
        "LET COUNT = 4\nLET PITCH = 60 / COUNT\nP0010 STOP",
    ),
    Finding(
        "Y0411",
        "wrong-argument",
        "error",
        "an argument of a CALL, or a default, doesn't fit the SUB's parameter",
        "A SUB's parameters are frames, numbers (with the unit that follows them), joint positions, inputs "
        "and outputs. Arguments stand in their order, or have their names (T=2); only a parameter with a "
        "default may have none. A default must fit as an argument does.",
        "SUB TURN A (deg)\n  P0010 DMOVEJ $A 0 0 0 0 0 [2] (deg,s)\nEND\nP0020 CALL TURN 20 (mm)",
        "SUB TURN A (deg)\n  P0010 DMOVEJ $A 0 0 0 0 0 [2] (deg,s)\nEND\nP0020 CALL TURN 20 (deg)",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0412",
        "bad-option",
        "error",
        "an option has the wrong argument, or doesn't belong to this command",
        "ACC takes a percentage, TOL a distance, NEAR the name of a joint position. Each option is given "
        "once.",
        "P0010 MOVEJ 10 0 0 0 0 0 [MIN] (deg) ACC 30",
        "P0010 MOVEJ 10 0 0 0 0 0 [MIN] (deg) ACC 30%",
    ),
    Finding(
        "Y0413",
        "bad-variable",
        "error",
        "the controller's variable can't be used",
        "Inputs and outputs are variables M, P or Q of the controller, 0 to 8191. Some are reserved for "
        "yarclang: those of the guard and the feedback, and the motors' positions.",
        "INPUT DOOR X11\nP0010 WAIT DOOR ON [5] (s)",
        "INPUT DOOR M11\nP0010 WAIT DOOR ON [5] (s)",
    ),
    Finding(
        "Y0414",
        "bad-count",
        "error",
        "the count of a REPEAT isn't an integer",
        "Loops are unrolled before the robot moves: their counts are integers, 0 or more.",
        "REPEAT 2.5\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND",
        "REPEAT 2\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND",
    ),
    Finding(
        "Y0415",
        "two-names-for-a-variable",
        "warning",
        "one variable of the controller is declared in two ways",
        "Setting one name changes the other as well, and the variable can have only one safe value. A "
        "digit may be mistyped.",
        "OUTPUT GRIP M1\nOUTPUT LAMP M1\nP0010 SET LAMP ON",
        "OUTPUT GRIP M1\nOUTPUT LAMP M2\nP0010 SET LAMP ON",
    ),
    Finding(
        "Y0416",
        "input-and-output",
        "error",
        "one variable of the controller is an input and an output",
        "A variable is set either by the program or from outside. A program that waits for its own output "
        "waits for nothing.",
        "INPUT CLOSED M1\nOUTPUT GRIP M1\nP0010 SET GRIP ON",
        "INPUT CLOSED M11\nOUTPUT GRIP M1\nP0010 SET GRIP ON",
    ),
    Finding(
        "Y0420",
        "no-circle",
        "error",
        "start, via and end give no circle",
        "MOVEC goes through three points. Points that coincide or lie on a line have no circle through "
        "them. A full circle is two arcs.",
        "P0010 MOVEC {TCP} 0 1174.4 1026; 0 1174.4 926 0 0 0 [4] (mm,deg,s) {B}",
        "P0010 MOVEJ 0 -10 -40 0 -30 0 [5] (deg,s)\n"
        "P0020 MOVEC {TCP} 50 1174.4 1126; 0 1174.4 1076 0 0 0 [MIN] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0421",
        "bad-timetable",
        "error",
        "the times of a timetable's way-points are wrong",
        "Each way-point of MOVEJ_TIMED has its time in square brackets, counted from the start of the "
        "motion, and times increase. VEL, and after it ACC, stand at all way-points or at none; the motion "
        "ends at rest.",
        "P0010 MOVEJ_TIMED 5 0 0 0 0 0 [2]; 9 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ_TIMED 5 0 0 0 0 0 [2]; 9 0 0 0 0 0 [4] (deg,s)",
    ),
    Finding(
        "Y0430",
        "not-at-run-time",
        "error",
        "an expression can't be computed while the program runs",
        "Registers and inputs are numbers without units, and registers are integers. There are + - * %, "
        "FLOOR(a / b), comparisons, AND, OR and NOT: each result is an integer, or true or false, on every "
        "controller. WHEN takes a condition that depends on a register or an input, SET a number.",
        "REGISTER N 0..9\nP0010 SET N = N / 2",
        "REGISTER N 0..9\nP0010 SET N = FLOOR(N / 2)",
    ),
    Finding(
        "Y0431",
        "bad-register",
        "error",
        "a register's range is invalid, or a value is outside of it",
        "A register is an integer in a range that the program names, so that a count that leaves the range "
        "ends the run with a reason. It begins with the lowest value, or with the value after the range.",
        "REGISTER N 9..0",
        "REGISTER N 0..9\nP0010 SET N = N + 1",
    ),
    Finding(
        "Y0432",
        "bad-case",
        "error",
        "an OF of a CASE is invalid or can never be chosen",
        "OF is followed by integers and ranges of integers. Each value belongs to one OF, and must be "
        "within the register's range: otherwise its lines never run.",
        "REGISTER N 0..2\nCASE N\n  OF 0 1\n    P0010 WAIT [1] (s)\n  OF 1..2\n    P0020 WAIT [2] (s)\nEND",
        "REGISTER N 0..2\nCASE N\n  OF 0\n    P0010 WAIT [1] (s)\n  OF 1..2\n    P0020 WAIT [2] (s)\nEND",
    ),
    Finding(
        "Y0433",
        "case-without-way",
        "error",
        "a CASE has no way for some values",
        "A robot that does nothing because a number was forgotten is a fault that is hard to find. Either "
        "each value of the register has an OF, or ELSE handles the others. An input may read any number, "
        "so its CASE always has an ELSE.",
        "INPUT JOB M70\nCASE JOB\n  OF 1\n    P0010 WAIT [1] (s)\nEND",
        'INPUT JOB M70\nCASE JOB\n  OF 1\n    P0010 WAIT [1] (s)\n  ELSE\n    P0020 HOLD "no such job"\nEND',
    ),
    Finding(
        "Y0434",
        "too-many-decimals",
        "error",
        "the value of an input, output or register has more decimals than a text",
        "A controller's text has nine decimals. A rounded WAIT or condition would compare with a number "
        "that isn't the program's.",
        "INPUT LEVEL M70\nP0010 WAIT LEVEL 0.1234567894 [5] (s)",
        "INPUT LEVEL M70\nP0010 WAIT LEVEL 0.123456789 [5] (s)",
    ),
    Finding(
        "Y0440",
        "wait-for-nothing",
        "error",
        "nothing in the condition of a WAIT can change while it waits",
        "Registers change in the program's own lines, and none of these runs during a WAIT: it would end "
        "at once or never. A register that other programs fill (REGISTER ... OUTSIDE) may stand alone.",
        "REGISTER N 0..5\nP0010 WAIT N = 3 [5] (s)",
        "REGISTER N 0..5\nINPUT FULL M11\nP0010 WAIT N = 3 OR FULL = ON [5] (s)",
    ),
    Finding(
        "Y0441",
        "no-register-in-braces",
        "error",
        "the name in braces in a SAY isn't a register",
        "Braces in the text of a SAY are replaced by the value of a register. Any other name would be "
        "shown to the operator unchanged.",
        'REGISTER N 0..5\nP0010 SAY "box {M}"',
        'REGISTER N 0..5\nP0010 SAY "box {N}"',
    ),
    Finding(
        "Y0450",
        "leaves-nothing",
        "error",
        "an EXIT or a RETURN stands where there is nothing to leave",
        "EXIT leaves the innermost LOOP or WHILE around it, in the same SUB; RETURN leaves the SUB and "
        "all loops in the SUB. Without a loop or a SUB around it, the line has no meaning.",
        "JOINTS A 10 0 0 0 0 0 (deg)\nP0010 MOVEJ A [2] (s)\nP0020 EXIT",
        "JOINTS A 10 0 0 0 0 0 (deg)\nP0010 MOVEJ A [2] (s)\nP0020 STOP",
    ),
    Finding(
        "Y0451",
        "else-of-no-wait",
        "error",
        "a WAIT with an ELSE has no condition or no time limit",
        "The lines of the ELSE run if the condition doesn't hold when the time is over. A WAIT without a "
        "condition, or without a time limit, never reaches them.",
        'INPUT DOOR M11\nP0010 WAIT DOOR ON ELSE\n  P0020 ABORT "the door is open"\nEND',
        'INPUT DOOR M11\nP0010 WAIT DOOR ON [5] (s) ELSE\n  P0020 ABORT "the door is open"\nEND',
    ),
    Finding(
        "Y0456",
        "beyond-table",
        "error",
        "a table has no number with this index",
        "Indices count from 0: a table of three numbers has the indices 0, 1 and 2. A missing number isn't "
        "replaced by another one, since the robot would go there.",
        "TABLE HEIGHTS 10 20 30\nLET TOP = HEIGHTS[3]\nP0010 STOP",
        "TABLE HEIGHTS 10 20 30\nLET TOP = HEIGHTS[2]\nP0010 STOP",
    ),
    Finding(
        "Y0457",
        "bad-index",
        "error",
        "a table is read with the wrong number or kind of indices",
        "A table of one row or one column has one index; any other table has two: the row, and the place "
        "in the row. An index is an integer without a unit.",
        "TABLE SPOTS 0 0; 60 40 (mm)\nLET X = SPOTS[1]\nP0010 STOP",
        "TABLE SPOTS 0 0; 60 40 (mm)\nLET X = SPOTS[1, 0]\nP0010 STOP",
    ),
    Finding(
        "Y0458",
        "uneven-table",
        "error",
        "the rows of a table aren't equally long",
        "A missing number would shift all numbers after it. All rows have as many numbers as the first row.",
        "TABLE SPOTS 0 0; 60\nLET X = SPOTS[0, 0]\nP0010 STOP",
        "TABLE SPOTS 0 0; 60 40\nLET X = SPOTS[0, 0]\nP0010 STOP",
    ),
    Finding(
        "Y0470",
        "group-out-of-range",
        "error",
        "a group of bits is invalid, or too small for the number",
        "A group is 2 to 16 variables of one letter that follow each other, the lowest bit first. Its "
        "value is an integer from 0 to the largest that its bits can hold; a larger number would lose its "
        "upper bits, and mean another number to the receiver.",
        "OUTPUT GO M80..M82\nP0010 SET GO 9",
        "OUTPUT GO M80..M83\nP0010 SET GO 9",
    ),
    Finding(
        "Y0471",
        "group-for-a-bit",
        "error",
        "a group of bits is used as a single bit",
        "WAIT looks at one input, and PULSE gives a pulse on one output. A number of several bits is for "
        "SET, WHEN and CASE; the sender signals that the number is valid by a bit of its own, a strobe.",
        "INPUT JOB M70..M72\nP0010 WAIT JOB 5 [5] (s)",
        "INPUT JOB M70..M72\nINPUT STROBE M73\nP0010 WAIT STROBE ON [5] (s)",
    ),
    Finding(
        "Y0476",
        "unshiftable-frame",
        "error",
        "a frame can't be shifted like that",
        "OFFSET shifts a frame that stands in the cell by registers: X, Y and Z in 0.01 mm, RZ in 0.01 "
        "degrees about its z axis. The range of each register is the box in which the frame may be. 0 "
        "belongs to it, since the place without a shift is what the program is proved with before it runs.",
        "REGISTER DX 5..2000 OUTSIDE\n"
        "FRAME {PART} 0 1174.4 1000 0 0 0 (mm,deg) {B}\n"
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "OFFSET {PART} X DX\n"
        "P0010 MOVEL 0 0 0 0 0 0 {PART}\n"
        "P0020 MOVEJ 0 0 0 0 30 0\n"
        "END",
        "REGISTER DX -2000..2000 0 OUTSIDE\n"
        "FRAME {PART} 0 1174.4 1000 0 0 0 (mm,deg) {B}\n"
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "OFFSET {PART} X DX\n"
        "P0010 MOVEL 0 0 0 0 0 0 {PART}\n"
        "P0020 MOVEJ 0 0 0 0 30 0\n"
        "END",
    ),
    Finding(
        "Y0477",
        "unplannable-in-offset",
        "error",
        "the lines of an OFFSET can't be planned as a whole when the program runs",
        "The lines of an OFFSET are planned and proved as a whole at the shifted frame, before the robot "
        "moves. So they have one way: motions, outputs and waits, and neither WHEN, loops, searches nor "
        "another OFFSET. They end at the place from which the lines after END are proved: at a MOVEL or "
        "MOVEJ to a place that isn't shifted.",
        "REGISTER DX -2000..2000 0 OUTSIDE\n"
        "FRAME {PART} 0 1174.4 1000 0 0 0 (mm,deg) {B}\n"
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "OFFSET {PART} X DX\n"
        "P0010 MOVEL 0 0 0 0 0 0 {PART}\n"
        "END\n"
        "P0020 MOVEJ 0 0 0 0 30 0",
        "REGISTER DX -2000..2000 0 OUTSIDE\n"
        "FRAME {PART} 0 1174.4 1000 0 0 0 (mm,deg) {B}\n"
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "OFFSET {PART} X DX\n"
        "P0010 MOVEL 0 0 0 0 0 0 {PART}\n"
        "P0020 MOVEJ 0 0 0 0 30 0\n"
        "END",
    ),
    Finding(
        "Y0478",
        "no-way-out",
        "error",
        "the SUB that an ON calls isn't a way on which the robot can leave",
        "A way out is planned and proved as a whole while the robot stands, and ends the program. So its "
        "SUB has only motions, SET of outputs and DWELL; put lines that wait, ask, decide or search into "
        "a program of their own. In a cell with parts it isn't known which parts the robot carries when "
        "it leaves: write HOLD there.",
        "INPUT CURTAIN M11\n"
        "SUB AWAY\n"
        "  P0010 STOP\n"
        "END\n"
        "ON CURTAIN OFF CALL AWAY\n"
        "P0020 MOVEJ 0 0 0 0 30 0 [2] (deg,s)",
        "INPUT CURTAIN M11\n"
        "SUB AWAY\n"
        "  P0010 MOVEJ HOME [3] (s)\n"
        "END\n"
        "ON CURTAIN OFF CALL AWAY\n"
        "P0020 MOVEJ 0 0 0 0 30 0 [2] (deg,s)",
    ),
    Finding(
        "Y0479",
        "no-way-out-from-here",
        "error",
        "the way of an ON can't be planned from each place at which it may begin",
        "After ON ... CALL has held a motion, the robot goes back to the start of that motion, and "
        "leaves from there. So the way is planned from the start of each motion. The message names the "
        "motion from which this fails, and the reason.",
        "INPUT CURTAIN M11\n"
        "SUB AWAY\n"
        "  P0010 DMOVEJ 100 0 0 0 0 0 [5] (deg,s)\n"
        "END\n"
        "ON CURTAIN OFF CALL AWAY\n"
        "P0020 MOVEJ 160 0 0 0 30 0 [6] (deg,s)\n"
        "P0030 MOVEJ HOME [6] (s)",
        "INPUT CURTAIN M11\n"
        "SUB AWAY\n"
        "  P0010 MOVEJ 90 0 0 0 0 0 [5] (deg,s)\n"
        "END\n"
        "ON CURTAIN OFF CALL AWAY\n"
        "P0020 MOVEJ 160 0 0 0 30 0 [6] (deg,s)\n"
        "P0030 MOVEJ HOME [6] (s)",
    ),
    Finding(
        "Y0480",
        "unknown-rule",
        "error",
        "KEEP doesn't know this rule, or its angle can't be kept",
        "KEEP takes UPRIGHT with an angle, by which the z axis of a carried frame may turn away from that "
        "of a frame that stands still, ABOVE with a distance from the plane of that frame, or FACING and "
        "SEEN with the angle of a cone. An angle is at least 0.1 deg, since no executed motion is exact, "
        "and at most 175 deg.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} LEVEL 100 (deg)\n  P0010 MOVEJ 10 0 0 0 30 0\nEND",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} UPRIGHT 100 (deg)\n  P0010 MOVEJ 10 0 0 0 30 0\nEND",
    ),
    Finding(
        "Y0482",
        "impossible-distance",
        "error",
        "a range of distances of KEEP can't be kept",
        "FACING and SEEN may have two distances after the angle, the least and the largest one. At the "
        "apex of a cone nothing has a direction, so that the least distance is 1 mm or more; and the "
        "largest one is at least 1 mm more, since no executed motion is exact.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "KEEP {TCP} SEEN 170 3000 200 (deg,mm)\n"
        "  P0010 MOVEJ 10 0 0 0 30 0\n"
        "END",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "KEEP {TCP} SEEN 170 200 3000 (deg,mm)\n"
        "  P0010 MOVEJ 10 0 0 0 30 0\n"
        "END",
    ),
    Finding(
        "Y0483",
        "needless-rule",
        "warning",
        "a KEEP asks for nothing that the KEEP around it doesn't",
        "All rules around a motion hold. A KEEP for the same frames with a wider limit, inside of one with "
        "a narrower limit, changes nothing, and its motions may still not use what it seems to allow.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "KEEP {TCP} UPRIGHT 100 (deg)\n"
        "  P0010 MOVEJ 10 0 0 0 30 0\n"
        "  KEEP {TCP} UPRIGHT 120 (deg)\n"
        "    P0020 MOVEJ 0 0 0 0 0 0\n"
        "  END\n"
        "END",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "KEEP {TCP} UPRIGHT 100 (deg)\n"
        "  P0010 MOVEJ 10 0 0 0 30 0\n"
        "END\n"
        "KEEP {TCP} UPRIGHT 120 (deg)\n"
        "  P0020 MOVEJ 0 0 0 0 0 0\n"
        "END",
    ),
    Finding(
        "Y0481",
        "keeps-nothing",
        "warning",
        "no line of a KEEP moves the robot",
        "KEEP is a rule for the motions up to its END. Without any, it does nothing.",
        "KEEP {TCP} UPRIGHT 100 (deg)\n  P0010 WAIT [1] (s)\nEND\nP0020 MOVEJ 10 0 0 0 30 0 [2] (deg,s)",
        "KEEP {TCP} UPRIGHT 100 (deg)\n  P0010 WAIT [1] (s)\n  P0020 MOVEJ 10 0 0 0 30 0 [2] (deg,s)\nEND",
    ),
    Finding(
        "Y0475",
        "unknown-place-behind-search",
        "error",
        "a line after a search begins at an unknown place",
        "A motion with UNTIL ends at a place that is known only when the program runs. SET, WAIT, HOLD and "
        "SAY may follow it; the next motion must be a MOVEL or MOVEJ to an absolute target, which is "
        "planned and proved when the place is known. Relative motions, splines, blends, loops and branches "
        "may stand after that motion.",
        "INPUT TOUCH M12\n"
        "P0010 MOVEJ 10 0 0 0 30 0 [2] (deg,s) UNTIL TOUCH\n"
        "P0020 DMOVEJ 5 0 0 0 0 0 [2] (deg,s)",
        "INPUT TOUCH M12\n"
        "P0010 MOVEJ 10 0 0 0 30 0 [2] (deg,s) UNTIL TOUCH\n"
        "P0020 MOVEJ 15 0 0 0 30 0 [2] (deg,s)",
    ),
    Finding(
        "Y0472",
        "analogue-value",
        "error",
        "an analogue signal can't have this value, or can't be used here",
        "An analogue signal is a group of bits that counts steps: `INPUT PRESSURE M80..M91 STEP 0.01`. It "
        "is compared with numbers that are known when the program is compiled, so that every decision at "
        "run time compares integers. = and a SET need a value that is an integer number of steps; < and > "
        "take any.",
        "OUTPUT FLOW M80..M87 STEP 0.5\nP0010 SET FLOW 2.2",
        "OUTPUT FLOW M80..M87 STEP 0.5\nP0010 SET FLOW 2",
    ),
    Finding(
        "Y0489",
        "unknown-parameter",
        "error",
        "an argument has a name that is no parameter of the SUB",
        "ROWS=4 gives the parameter ROWS of the SUB that is called. The names are those in the head of the "
        "SUB, a frame's without braces.",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN 20 TT=3",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN 20 T=3",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0490",
        "parameter-twice",
        "error",
        "a parameter is given twice in a CALL",
        "An argument without a name belongs to the parameter at its position; an argument with a name "
        "belongs to the parameter of that name. Each parameter has one value.",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN 20 A=30",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN 20 T=3",
    ),
    Finding(
        "Y0491",
        "unnamed-after-named",
        "error",
        "an argument without a name follows one with a name",
        "Arguments without names are counted from the left. After a name nobody would see which parameter "
        "such an argument belongs to.",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN T=3 20",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN 20 T=3",
    ),
)

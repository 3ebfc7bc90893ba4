"""Findings of family 04: values."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0401",
        "wrong-number-of-values",
        "error",
        "too few or too many values",
        "A joint position has one value for each joint; a pose has x y z and an orientation.",
        "P0010 MOVEJ 0 0 0 0 30 [5] (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0402",
        "not-a-number",
        "error",
        "this is not a number",
        "A number is an optional sign, digits with an optional decimal point, and an optional exponent. "
        "Numbers are separated by blanks. `30-5` may mean two values, and `0,5` may mean 0.5; the meaning "
        "isn't guessed.",
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
        "The values qx qy qz qw of an orientation must have the norm 1. If the norm is off by more than "
        "0.001, a value is missing, mistyped or in the wrong order.",
        "P0010 MOVEJ_QUAT {TCP} 0 1174.4 1176 0 0 0 2 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_QUAT {TCP} 0 1174.4 1176 0 0 0 1 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0405",
        "wrong-number-of-waypoints",
        "error",
        "too few or too many waypoints",
        "MOVEJ and MOVEL take one waypoint; a spline takes two or more, separated by semicolons.",
        "P0010 MOVEJ 0 0 0 0 0 0; 0 0 0 0 30 0 [5] (deg,s)",
        "P0010 MOVEJ_SPLINE 0 0 0 0 10 0; 0 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y0406",
        "missing-time",
        "error",
        "the motion time is missing",
        "The speed of the robot is never guessed. `[20]` gives the duration of the whole motion; `[MIN]` is "
        "the shortest duration that the limits allow.",
        "P0010 MOVEJ 0 0 0 0 30 0 (deg,s)",
        "P0010 MOVEJ 0 0 0 0 30 0 [MIN] (deg,s)",
        needs="default",
    ),
    Finding(
        "Y0407",
        "bad-time",
        "error",
        "the motion time is invalid",
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
        "An unused part most likely means that another command was intended.",
        "P0010 STOP [5] (s)",
        "P0010 STOP",
    ),
    Finding(
        "Y0409",
        "half-turn",
        "error",
        "a rotation by half a turn has no shortest direction",
        "A straight motion rotates about one axis, in the direction with the smaller angle. At half a turn, "
        "the angles of both directions are equal. Beyond half a turn, the robot would rotate in the "
        "opposite direction. To choose the direction, divide the motion at a pose in between.",
        "P0010 DMOVE {TCP} 0 0 0 0 180 0 [5] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 0 0 0 90 0 [5] (mm,deg,s) {B}\n"
        "P0020 DMOVE {TCP} 0 0 0 0 90 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0410",
        "not-computable",
        "error",
        "the expression can't be computed",
        "The expression divides by zero, takes the root of a negative number, or overflows.",
        "LET COUNT = 0\nLET PITCH = 60 / COUNT\nP0010 STOP",
        "LET COUNT = 4\nLET PITCH = 60 / COUNT\nP0010 STOP",
    ),
    Finding(
        "Y0411",
        "wrong-argument",
        "error",
        "an argument of a CALL, or a default, doesn't fit the SUB's parameter",
        "A parameter of a SUB is a frame, a number (with the unit after it), a joint position, an input or "
        "an output. Arguments are given in the order of the parameters, or by name (T=2); only parameters "
        "with a default may be left out. A default must have the kind of its parameter too.",
        "SUB TURN A (deg)\n  P0010 DMOVEJ $A 0 0 0 0 0 [2] (deg,s)\nEND\nP0020 CALL TURN 20 (mm)",
        "SUB TURN A (deg)\n  P0010 DMOVEJ $A 0 0 0 0 0 [2] (deg,s)\nEND\nP0020 CALL TURN 20 (deg)",
        needs="name",
        hides="names",
    ),
    Finding(
        "Y0412",
        "bad-option",
        "error",
        "an option has a wrong argument, or isn't allowed with this command",
        "ACC takes a percentage, TOL and BLEND a distance, NEAR the name of a joint position, ALLOW two "
        "bodies. Each option may be given once; the message names the option and what it takes.",
        "P0010 MOVEJ 10 0 0 0 0 0 [MIN] (deg) ACC 30",
        "P0010 MOVEJ 10 0 0 0 0 0 [MIN] (deg) ACC 30%",
    ),
    Finding(
        "Y0413",
        "bad-variable",
        "error",
        "the controller's variable can't be used",
        "Inputs and outputs are variables M, P or Q of the controller, 0 to 8191. The variables of the "
        "guard, of the feedback and of the motors' positions are reserved for yarclang.",
        "INPUT DOOR X11\nP0010 WAIT DOOR ON [5] (s)",
        "INPUT DOOR M11\nP0010 WAIT DOOR ON [5] (s)",
    ),
    Finding(
        "Y0414",
        "bad-count",
        "error",
        "the count of a REPEAT isn't an integer",
        "Loops are unrolled before the robot moves, so the count of a REPEAT must be an integer, 0 or more.",
        "REPEAT 2.5\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND",
        "REPEAT 2\n  P0010 DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND",
    ),
    Finding(
        "Y0415",
        "two-names-for-a-variable",
        "warning",
        "one variable of the controller is declared in two ways",
        "A SET of one name would also change the other one, and the variable can have only one safe value. "
        "A digit may be mistyped.",
        "OUTPUT GRIP M1\nOUTPUT LAMP M1\nP0010 SET LAMP ON",
        "OUTPUT GRIP M1\nOUTPUT LAMP M2\nP0010 SET LAMP ON",
    ),
    Finding(
        "Y0416",
        "input-and-output",
        "error",
        "one variable of the controller is an input and an output",
        "A variable is set either by the program or from outside. A program that waits for its own output "
        "would wait for ever, or not at all.",
        "INPUT CLOSED M1\nOUTPUT GRIP M1\nP0010 SET GRIP ON",
        "INPUT CLOSED M11\nOUTPUT GRIP M1\nP0010 SET GRIP ON",
    ),
    Finding(
        "Y0420",
        "no-circle",
        "error",
        "start, via and end pose define no circle",
        "MOVEC goes through three points. Points that coincide or lie on a line have no circle through "
        "them. Write a full circle as two arcs.",
        "P0010 MOVEC {TCP} 0 1174.4 1026; 0 1174.4 926 0 0 0 [4] (mm,deg,s) {B}",
        "P0010 MOVEJ 0 -10 -40 0 -30 0 [5] (deg,s)\n"
        "P0020 MOVEC {TCP} 50 1174.4 1126; 0 1174.4 1076 0 0 0 [MIN] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0421",
        "bad-timetable",
        "error",
        "the times of a timetable's waypoints are wrong",
        "Each waypoint of MOVEJ_TIMED has its time in square brackets, counted from the start of the "
        "motion. The times must increase. Velocities (VEL) must be given at all waypoints or at none; the "
        "same applies to accelerations (ACC), which need VEL before them. The motion must end at rest.",
        "P0010 MOVEJ_TIMED 5 0 0 0 0 0 [2]; 9 0 0 0 0 0 [1] (deg,s)",
        "P0010 MOVEJ_TIMED 5 0 0 0 0 0 [2]; 9 0 0 0 0 0 [4] (deg,s)",
    ),
    Finding(
        "Y0430",
        "not-at-run-time",
        "error",
        "an expression can't be computed while the program runs",
        "Registers and inputs are numbers without units, and registers are integers. An expression with "
        "registers or inputs may only use + - * %, FLOOR(a / b), comparisons, AND, OR and NOT, because "
        "their results are the same on every controller. WHEN needs a condition with a register or an "
        "input. SET needs a number.",
        "REGISTER N 0..9\nP0010 SET N = N / 2",
        "REGISTER N 0..9\nP0010 SET N = FLOOR(N / 2)",
    ),
    Finding(
        "Y0431",
        "bad-register",
        "error",
        "a register's range is invalid, or a value is outside of it",
        "A register is an integer within a declared range; a value outside of the range would end the run "
        "with an error. The register starts with the lowest value of its range, or with the value given "
        "after the range.",
        "REGISTER N 9..0",
        "REGISTER N 0..9\nP0010 SET N = N + 1",
    ),
    Finding(
        "Y0432",
        "bad-case",
        "error",
        "an OF of a CASE is invalid or can never be chosen",
        "OF takes integers and ranges of integers. Each value may be given in one OF only. It must be "
        "within the range of the register, otherwise the lines of its OF would never run.",
        "REGISTER N 0..2\nCASE N\n  OF 0 1\n    P0010 WAIT [1] (s)\n  OF 1..2\n    P0020 WAIT [2] (s)\nEND",
        "REGISTER N 0..2\nCASE N\n  OF 0\n    P0010 WAIT [1] (s)\n  OF 1..2\n    P0020 WAIT [2] (s)\nEND",
    ),
    Finding(
        "Y0433",
        "case-without-way",
        "error",
        "a CASE doesn't handle all values",
        "A value without an OF would be ignored at run time, which is hard to notice. Give each value of "
        "the register an OF, or add an ELSE for all others. An input can have any value, so its CASE "
        "always needs an ELSE.",
        "INPUT JOB M70\nCASE JOB\n  OF 1\n    P0010 WAIT [1] (s)\nEND",
        'INPUT JOB M70\nCASE JOB\n  OF 1\n    P0010 WAIT [1] (s)\n  ELSE\n    P0020 HOLD "no such job"\nEND',
    ),
    Finding(
        "Y0434",
        "too-many-decimals",
        "error",
        "a value for an input, output or register has too many decimals",
        "Values in the controller's text have at most nine decimals. After rounding, a WAIT or a condition "
        "would compare with a different number.",
        "INPUT LEVEL M70\nP0010 WAIT LEVEL 0.1234567894 [5] (s)",
        "INPUT LEVEL M70\nP0010 WAIT LEVEL 0.123456789 [5] (s)",
    ),
    Finding(
        "Y0440",
        "wait-for-nothing",
        "error",
        "nothing in the condition of a WAIT can change while it waits",
        "Only other lines of the program change this register, and none of them runs during a WAIT. So the "
        "WAIT would end at once or never. Use an input, or a register that other programs fill (REGISTER "
        "... OUTSIDE).",
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
        "an EXIT is outside of a loop, or a RETURN outside of a SUB",
        "EXIT leaves the innermost LOOP or WHILE around it, in the same SUB; RETURN leaves the SUB and all "
        "loops in the SUB.",
        "JOINTS A 10 0 0 0 0 0 (deg)\nP0010 MOVEJ A [2] (s)\nP0020 EXIT",
        "JOINTS A 10 0 0 0 0 0 (deg)\nP0010 MOVEJ A [2] (s)\nP0020 STOP",
    ),
    Finding(
        "Y0451",
        "else-of-no-wait",
        "error",
        "a WAIT with an ELSE has no condition or no time limit",
        "The lines of the ELSE run if the condition isn't true within the time limit. Without a condition "
        "or a time limit, they would never run.",
        'INPUT DOOR M11\nP0010 WAIT DOOR ON ELSE\n  P0020 ABORT "the door is open"\nEND',
        'INPUT DOOR M11\nP0010 WAIT DOOR ON [5] (s) ELSE\n  P0020 ABORT "the door is open"\nEND',
    ),
    Finding(
        "Y0456",
        "beyond-table",
        "error",
        "a table has no number with this index",
        "Indices count from 0: a table of three numbers has the indices 0, 1 and 2. An index outside the "
        "table is never replaced by the nearest valid one, because the robot could then move to a wrong "
        "place.",
        "TABLE HEIGHTS 10 20 30\nLET TOP = HEIGHTS[3]\nP0010 STOP",
        "TABLE HEIGHTS 10 20 30\nLET TOP = HEIGHTS[2]\nP0010 STOP",
    ),
    Finding(
        "Y0457",
        "bad-index",
        "error",
        "a table is read with the wrong number or kind of indices",
        "A table with one row or one column takes one index; any other table takes two: the row, and the "
        "column. An index is an integer without a unit.",
        "TABLE SPOTS 0 0; 60 40 (mm)\nLET X = SPOTS[1]\nP0010 STOP",
        "TABLE SPOTS 0 0; 60 40 (mm)\nLET X = SPOTS[1, 0]\nP0010 STOP",
    ),
    Finding(
        "Y0458",
        "uneven-table",
        "error",
        "the rows of a table aren't equally long",
        "All rows must have as many numbers as the first row: one missing number would shift all others.",
        "TABLE SPOTS 0 0; 60\nLET X = SPOTS[0, 0]\nP0010 STOP",
        "TABLE SPOTS 0 0; 60 40\nLET X = SPOTS[0, 0]\nP0010 STOP",
    ),
    Finding(
        "Y0470",
        "group-out-of-range",
        "error",
        "a group of bits is invalid, or too small for the number",
        "A group has 2 to 16 consecutive variables of one letter, the lowest bit first. Its value is an "
        "integer from 0 to the largest that its bits can represent; a larger number would lose its upper "
        "bits, so that the receiver reads a different number.",
        "OUTPUT GO M80..M82\nP0010 SET GO 9",
        "OUTPUT GO M80..M83\nP0010 SET GO 9",
    ),
    Finding(
        "Y0471",
        "group-for-a-bit",
        "error",
        "a group of bits is used as a single bit",
        "WAIT, UNTIL and ON read one input, and PULSE sets one output. Use SET, WHEN and CASE for a number "
        "of several bits; the sender should signal a valid number by a separate bit, a strobe.",
        "INPUT JOB M70..M72\nP0010 WAIT JOB 5 [5] (s)",
        "INPUT JOB M70..M72\nINPUT STROBE M73\nP0010 WAIT STROBE ON [5] (s)",
    ),
    Finding(
        "Y0476",
        "unshiftable-frame",
        "error",
        "an OFFSET can't shift this frame in this way",
        "OFFSET shifts a frame by the values of registers: X, Y and Z in steps of 0.01 mm, RZ in steps of "
        "0.01 degrees about the frame's z axis. The frame must be fixed in the cell. The ranges of the "
        "registers limit the shift. Each range must include 0, because the program is compiled and proved "
        "without a shift.",
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
        "moves. So they can't branch: motions, outputs and waits are allowed, but no WHEN, loops, searches "
        "or other OFFSETs. The last motion must be a MOVEL or MOVEJ to a place that isn't shifted, because "
        "the lines after END are proved from that place.",
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
        "the SUB that an ON calls can't be used as a way out",
        "When the input of an ON ... CALL changes, the robot stops. Then the SUB moves the robot away, and "
        "the program ends. The SUB is planned and proved as a whole while the robot is at rest. So it needs "
        "at least one motion, and may contain only motions, SET of outputs and WAIT for a time; put lines "
        "that wait for an input, ask, decide or search into another program. In a cell with parts, use HOLD "
        "instead of CALL, because it isn't known which parts the robot carries when it is stopped.",
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
        "the SUB of an ON can't be planned from each place at which it may begin",
        "After ON ... CALL has held a motion, the robot first returns to the start of that motion, and then "
        "carries out the SUB. So the SUB is planned from the start of each motion of the program. The "
        "message names the motion for which this fails, and the reason.",
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
        "the rule of a KEEP is unknown, or its angle is out of range",
        "KEEP has four rules. UPRIGHT takes the largest angle between the z axes of a carried and a fixed "
        "frame. ABOVE takes the smallest distance from the plane of the fixed frame. FACING and SEEN take "
        "the angle of a cone. An angle must be at least 0.1 deg, because no executed motion is exact, and "
        "at most 175 deg.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} LEVEL 100 (deg)\n  P0010 MOVEJ 10 0 0 0 30 0\nEND",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} UPRIGHT 100 (deg)\n  P0010 MOVEJ 10 0 0 0 30 0\nEND",
    ),
    Finding(
        "Y0482",
        "impossible-distance",
        "error",
        "the range of distances of a KEEP is invalid",
        "After the angle of FACING or SEEN, two distances may follow: the smallest and the largest. The "
        "smallest must be at least 1 mm, because no direction is defined at the apex of the cone. The "
        "largest must exceed the smallest by at least 1 mm, because no executed motion is exact.",
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
        "a KEEP has no effect inside a stricter KEEP",
        "A motion must observe every KEEP around it. If the inner KEEP has the same rule and frames as the "
        "outer one, but a wider limit, it has no effect: the narrower limit of the outer KEEP applies "
        "anyway.",
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
        "KEEP is a rule for the motions up to its END. Without a motion it has no effect.",
        "KEEP {TCP} UPRIGHT 100 (deg)\n  P0010 WAIT [1] (s)\nEND\nP0020 MOVEJ 10 0 0 0 30 0 [2] (deg,s)",
        "KEEP {TCP} UPRIGHT 100 (deg)\n  P0010 WAIT [1] (s)\n  P0020 MOVEJ 10 0 0 0 30 0 [2] (deg,s)\nEND",
    ),
    Finding(
        "Y0475",
        "unknown-place-behind-search",
        "error",
        "a line after a search begins at an unknown place",
        "A motion with UNTIL ends at a place that is known only when the program runs. SET, WAIT, HOLD and "
        "SAY may follow it. The next motion must be a MOVEL or MOVEJ to an absolute target; it is planned "
        "and proved at run time, as soon as the place is known. After that motion, relative motions, "
        "splines, blends, loops and branches are possible again.",
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
        "an analogue signal can't have this value, or isn't allowed here",
        "An analogue signal is a group of bits whose value counts steps: `INPUT PRESSURE M80..M91 STEP "
        "0.01`. It can be compared only with numbers that are known when the program is compiled, so that "
        "every decision at run time compares integers. After = and in a SET, the number must be a multiple "
        "of the step; after < and > it may be any number.",
        "OUTPUT FLOW M80..M87 STEP 0.5\nP0010 SET FLOW 2.2",
        "OUTPUT FLOW M80..M87 STEP 0.5\nP0010 SET FLOW 2",
    ),
    Finding(
        "Y0489",
        "unknown-parameter",
        "error",
        "the SUB has no parameter with the name of this argument",
        "For example, ROWS=4 gives the value 4 to the parameter ROWS of the called SUB. The names of the "
        "parameters are in the first line of the SUB. Write the name of a frame without braces.",
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
        "Arguments without names belong to the parameters in their order, from the left. After a named "
        "argument, it wouldn't be clear which parameter an argument without a name belongs to.",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN T=3 20",
        "SUB TURN A (deg) T=2 (s)\n  P0010 MOVEJ $A 0 0 0 -30 0 [$T] (deg,s)\nEND\nP0020 CALL TURN 20 T=3",
    ),
)

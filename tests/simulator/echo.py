"""A minimal machine, for tests of the code around it."""

from yarclang.simulator.network.reply import Reply, framed


class Echo:
    """A machine that answers a line with itself.

    It answers `ERR6` with error 6, `LONG300` with 300 lines, and `SET` with nothing.
    """

    def __init__(self):
        self.now = 0.0
        self.heard = []
        self.done = []
        self.advanced = []
        self.news = {}

    def advance(self, seconds):
        assert seconds > 0
        self.advanced.append(seconds)
        self.now += seconds

    def command(self, line, port=0):
        self.heard.append((port, line))
        if line.startswith("ERR"):
            return Reply(("before",), int(line[3:]))
        if line.startswith("LONG"):
            return Reply(tuple(f"LINE {number}" for number in range(int(line[4:]))))
        if line.startswith("SET"):
            return Reply()
        if line == "BUG":
            raise ZeroDivisionError
        return Reply((line,))

    def respond(self, line, port=0):
        return framed(self.command(line, port), 2, 1)

    def control(self, character, port=0):
        self.heard.append((port, character))
        return Reply(("1.5 2.5",)) if character == 0x10 else Reply()

    def messages(self, port=0):
        return self.news.pop(port, ())

    def fault_amplifier(self, motor):
        self.done.append((self.now, "amplifier", motor))

    def set_limit_switch(self, motor, side, on):
        self.done.append((self.now, "limit", motor, side, on))

    def disturb(self, motor, counts):
        self.done.append((self.now, "following", motor, counts))

    def reset(self):
        self.done.append((self.now, "reset"))

"""What is remembered stays bounded, and what is in use stays remembered."""

from yarclang.memory import Lately, Recent, recall


def test_results_that_were_not_used_lately_are_forgotten():
    memory = Recent(10)
    for number in range(25):
        recall(memory, number, lambda number=number: str(number))
    assert len(memory) == 10
    assert (memory.get(24), memory.get(15), memory.get(14)) == ("24", "15", None)


def test_what_is_used_again_stays():
    memory = Recent(10)
    for number in range(100):
        recall(memory, number, lambda number=number: str(number))
        recall(memory, "always", lambda: "here")
    assert memory.get("always") == "here"
    assert len(memory) == 10


def test_after_a_large_look_what_is_kept_shrinks_again():
    memory = Recent(10_000)
    for number in range(5_000):
        memory.keep(number, "large")
    memory.settle(100)
    assert len(memory) == 5_000
    sizes = []
    for look in range(100):
        for number in range(30):
            memory.keep((look % 2, number), "small")
        memory.settle(100)
        sizes.append(len(memory))
    assert sizes[-1] == 100
    assert max(sizes) <= 5_060
    assert memory.get((1, 29)) == "small"


def test_no_results_are_lost_by_a_large_look_that_comes_again():
    memory, misses = Recent(10_000), []
    for _ in range(5):
        before = memory.misses
        for number in range(3_000):
            recall(memory, number, lambda: "one")
        memory.settle(100)
        misses.append(memory.misses - before)
    assert misses == [3_000, 0, 0, 0, 0]


def test_a_function_keeps_what_it_has_given_lately():
    made = []

    def make(text, line):
        made.append((text, line))
        return f"{text}{line}"

    function = Lately(make, 10)
    for number in range(1_000):
        assert function("a", number) == f"a{number}"
        assert function("always", 1) == "always1"
        assert len(function) <= 20
    assert made.count(("always", 1)) == 1
    assert len(made) == 1_001


def test_a_long_text_is_kept_whole_until_it_was_read_again():
    made = []
    function = Lately(lambda number: made.append(number) or -number, 10)
    for _ in range(4):
        function.expect(500)
        assert [function(number) for number in range(500)] == [-number for number in range(500)]
    assert len(made) == 500
    function.expect(5)
    for number in range(600, 700):
        function(number)
    assert len(function) <= 20
    function.cache_clear()
    assert len(function) == 0

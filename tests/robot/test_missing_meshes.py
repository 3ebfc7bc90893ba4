"""Tests of collision meshes that aren't at the given paths: they are found elsewhere, or the refusal says
what helps.
"""

import pytest

from tests.robot.made_arms import yarc
from tests.robot.test_new_robot import solid
from tests.robot.trap_arms import arm, joint, link, robot, written

MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
END = "meshes/arm/visit.stl"
FOREIGN = {
    "a package": f"package://arm_x/{END}",
    "a file of another computer": f"file:///home/somebody/cad/{END}",
    "a path of another computer": f"/home/somebody/cad/{END}",
    "Windows": "C:\\cad\\" + END.replace("/", "\\"),
    "Gazebo": f"model://arm_x/{END}",
    "a way up": f"../../../{END}",
    "a blank as %20": f"package://arm_x/my%20files/{END}",
}


def with_meshes(folder, *names):
    """Return the file of an arm with a link on its foot for each mesh."""
    parts = [
        link(f"s{at}", MESH.format(name), shape=False) + joint(f"j{at}", "base_link", f"s{at}", kind="fixed")
        for at, name in enumerate(names)
    ]
    return written(folder / "given", robot(arm(), *parts))


def new(file, *options):
    return yarc("robot", "new", file, "--yes", "-o", file.parent.parent / "r", *options)


@pytest.mark.parametrize("name", FOREIGN)
def test_a_mesh_is_found_by_the_end_of_its_name_where_the_user_says(name, tmp_path):
    file = with_meshes(tmp_path, FOREIGN[name])
    refused = new(file)
    assert refused.exit_code == 1
    assert "Y1357" in refused.output
    assert all(words in refused.output for words in ("visit.stl of s0", "--meshes", "--package-path"))
    assert not (tmp_path / "r").exists()
    for place, text in (("mine/visit.stl", "other"), (f"mine/{END}", "right")):
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).write_text(solid(text))
    result = new(file, "--meshes", tmp_path / "mine")
    assert result.exit_code == 0, result.output
    # the file whose path has the longest common end is used
    assert (tmp_path / "r/meshes/visit.stl").read_text() == solid("right")


def test_where_they_were_looked_for_is_said(tmp_path):
    (tmp_path / "ws/there").mkdir(parents=True)
    (tmp_path / "ws/there/package.xml").write_text("<package><name>there</name></package>")
    names = ["package://there/a.stl", "package://gone/b.stl", "c.stl", "http://example.org/d.stl"]
    file = with_meshes(tmp_path, *names, *(f"more{number}.stl" for number in range(300)))
    result = new(file, "--package-path", tmp_path / "ws")
    assert result.exit_code == 1
    text = " ".join(result.output.split())
    assert "304 collision meshes aren't there" in text
    assert "300 more" in text
    assert f"The package there is {tmp_path / 'ws/there'}" in text
    assert f"The package gone was searched in {tmp_path / 'given'}" in text
    assert f"below {tmp_path / 'ws'}" in text
    assert len(result.output) < 3000


def test_ros_2_names_its_packages_as_well(tmp_path, monkeypatch):
    share = tmp_path / "ros/share/arm_x"
    share.mkdir(parents=True)
    (share / "package.xml").write_text("<package><name>arm_x</name></package>")
    (share / "a.stl").write_text(solid("a"))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "ros"))
    assert new(with_meshes(tmp_path, "package://arm_x/a.stl")).exit_code == 0


def test_nothing_is_asked_before_they_are_missed(tmp_path):
    file = with_meshes(tmp_path, "gone.stl")
    result = yarc("robot", "new", file, "-o", tmp_path / "r")  # without --yes, questions would be asked
    assert result.exit_code == 1
    assert "Y1357" in result.output
    assert "--acceleration" not in result.output


def test_an_empty_file_is_called_so(tmp_path):
    file = with_meshes(tmp_path, "a.stl")
    (tmp_path / "given/a.stl").touch()
    result = new(file)
    assert result.exit_code == 1
    assert "a.stl is empty" in result.output


def test_a_pointer_of_git_lfs_is_called_so(tmp_path):
    file = with_meshes(tmp_path, "a.stl")
    (tmp_path / "given/a.stl").write_text(
        "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n"
    )
    result = new(file, "--allow-missing-meshes")
    assert result.exit_code == 1
    assert "git lfs pull" in result.output


def test_what_is_only_drawn_may_miss(tmp_path):
    visual = MESH.format("gone.dae").replace("collision", "visual")
    file = written(
        tmp_path / "given", robot(arm(), link("s", visual), joint("j", "base_link", "s", kind="fixed"))
    )
    result = new(file)
    assert result.exit_code == 0, result.output
    assert "the visual mesh gone.dae isn't there" in result.output


def test_many_drawn_meshes_that_miss_are_one_note(tmp_path):
    bodies = "".join(MESH.format(f"gone{k}.dae").replace("collision", "visual") for k in range(5))
    file = written(
        tmp_path / "given", robot(arm(), link("s", bodies), joint("j", "base_link", "s", kind="fixed"))
    )
    result = new(file)
    assert result.exit_code == 0, result.output
    assert "5 visual meshes: gone0.dae, gone1.dae, gone2.dae and 2 more aren't there" in result.output
    assert result.output.count("give the folder with --package-path or --meshes") == 1


def test_the_robot_without_them_says_so(tmp_path):
    file = with_meshes(tmp_path, "gone.stl", "lost.stl")
    result = new(file, "--allow-missing-meshes")
    assert result.exit_code == 0
    assert "Y1366" in result.output
    assert "2 collision meshes left out: gone.stl of s0, lost.stl of s1" in result.output
    text = (tmp_path / "r/arm.urdf").read_text()
    assert "gone.stl" not in text
    assert yarc("robot", "check", tmp_path / "r").exit_code in (0, 1)

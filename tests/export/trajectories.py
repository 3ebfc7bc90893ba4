"""Exports of trajectories in tests, and readers of the exported texts that use no code of yarclang."""

import json

import numpy as np
import yaml
from programs import compiled
from scipy.interpolate import BPoly, CubicHermiteSpline

from yarclang.export.ros.exported import Wishes, exported
from yarclang.export.ros.writing import json_text, yaml_text
from yarclang.independent.reading import read

_PARTS = {1: ("secs", "nsecs"), 2: ("sec", "nanosec")}


def made_of(text, robot="INDUSTRIAL6", tolerance=1e-4, straight=False, **request):
    """Return the compiled program, its export, and the findings of the export."""
    program, found = compiled(text, robot=robot, **request)
    assert program is not None, [one.message for one in found]
    result = exported(program, Wishes(tolerance, straight))
    return program, result.value, result.diagnostics


def read_yaml(text, version=2):
    """Return the times [ns], positions, velocities and accelerations of each trajectory."""
    return [_arrays(one, version) for one in yaml.safe_load_all(text)]


def read_json(text, version=2):
    return [_arrays(one["trajectory"], version) for one in json.loads(text)["trajectories"]]


def _arrays(message, version):
    whole, part = _PARTS[version]
    points = message["points"]
    times = [one["time_from_start"][whole] * 10**9 + one["time_from_start"][part] for one in points]
    rest = (np.array([one[key] for one in points]) for key in ("positions", "velocities", "accelerations"))
    assert {len(message["joint_names"])} == {len(one["positions"]) for one in points}
    return np.array(times), *rest


def driven(kind, trajectory, at):
    """Return the positions at times `at` [s] (N, n) of a driver with `kind` of interpolation."""
    times, x, v, a = trajectory
    t = times * 1e-9
    at = np.clip(at, 0.0, t[-1])
    if kind == "linear":
        return np.stack([np.interp(at, t, column) for column in x.T], axis=1)
    if kind == "cubic":
        return CubicHermiteSpline(t, x, v)(at)
    return BPoly.from_derivatives(t, np.stack((x, v, a), axis=1))(at)


def executed(text, arm_units, stretches):
    """Return dense times [s] and positions [rad or m] for each stretch, and its duration. A stretch is given
    as the steps of its motions.
    """
    _, commands = read(text)
    found = []
    for steps in stretches:
        begin, times, places = 0.0, [], []
        for step in steps:
            one = commands[step]
            count = (len(one.control) - 3) * 11 + 1
            own = np.linspace(0.0, one.duration, count)
            times.append(begin + own)
            places.append(one.spline(own) * arm_units)
            begin += one.duration
        found.append((np.concatenate(times), np.concatenate(places), begin))
    return found


def both_texts(made, version=2):
    return yaml_text(made, version), json_text(made, version)

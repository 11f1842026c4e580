"""Measures in a file of their own, as a user of the sweep example writes them."""

import os
import time

import numpy as np


def whose(actuator, scene):
    """Which process and which actuator ran the scene."""
    actuator.start(scene)
    return {"process": os.getpid(), "actuator": id(actuator)}


FACTOR = 2.0


def twice(number):
    """What `doubled` is made with."""
    return FACTOR * number


def doubled(actuator, scene):
    """Results of every kind; some scenes have one more, others one less."""
    voltage = twice(scene["phi"])
    found = {"twice": np.float32(voltage), "large": np.bool_(voltage > 0.5), "kind": "large" if voltage > 0.5 else None}
    return {**found, "more": np.int64(3)} if voltage > 0.5 else found


def fatal(actuator, scene):
    """Takes its worker down with the scene phi = 0.5, after some seconds in which what it has done is fetched."""
    if scene["phi"] == 0.5:
        time.sleep(3)
        os._exit(1)
    return {"twice": 2 * scene["phi"]}


def slow(actuator, scene):
    """Takes a fifth of a second."""
    time.sleep(0.2)
    return {"twice": 2 * scene["phi"]}

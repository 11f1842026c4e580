"""Measures in a file of their own, as a user of the sweep example writes them."""

import os
import time


def whose(actuator, scene):
    """Which process and which actuator ran the scene."""
    actuator.start(scene)
    return {"process": os.getpid(), "actuator": id(actuator)}


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

"""The motion of a dielectric elastomer actuator with surface effects: run, sweep, plot, fit.

* `Actuator`: one instance of a packed FMU, nondimensional or in SI units; `frame` makes a pandas table of a response;
* `presets`: scenes that show a motion, and materials;
* `ensemble`, `grid`: many scenes at once, in SIMD lanes on every core;
* `sensitivities`: a motion with its derivatives by the parameters, integrated along with it;
* `identification.fit`: parameters from measured data, which `measured` reads (extra ``fit``); `device` leads from SI
  units to the nondimensional model;
* `plot`: history, phase portrait, pull-in margin (extra ``plot``).

The nondimensional model is that of A. P. Singh, G. Shmuel and A. K. Sharma, *Nonlinear dynamics of miniaturized
dielectric elastomer actuators with surface effects*.
"""

from importlib.metadata import PackageNotFoundError, version

from fmpy.fmi1 import FMICallException

try:
    __version__ = version("dielectric-actuator")
except PackageNotFoundError:  # the sources, not installed
    __version__ = "0"

from . import presets
from .actuator import Actuator, SavedState, Scene, frame
from .fmu import LogMessage, UnknownName, packed_fmu
from .native import Collapse, ensemble, grid, sensitivities

__all__ = [
    "Actuator",
    "Collapse",
    "FMICallException",
    "LogMessage",
    "SavedState",
    "Scene",
    "UnknownName",
    "ensemble",
    "frame",
    "grid",
    "packed_fmu",
    "presets",
    "sensitivities",
]

"""The motion of a dielectric elastomer actuator with surface effects: run, sweep, plot, fit.

* `Actuator`: one instance of the packed FMU, by name;
* `frame`: a response as a pandas table.

The model is that of A. P. Singh, G. Shmuel and A. K. Sharma, *Nonlinear dynamics of miniaturized dielectric
elastomer actuators with surface effects*.
"""

from importlib.metadata import PackageNotFoundError, version

from fmpy.fmi1 import FMICallException

from .actuator import Actuator, SavedState, Scene, frame
from .fmu import LogMessage, UnknownName, packed_fmu

try:
    __version__ = version("dielectric-actuator")
except PackageNotFoundError:  # the sources, not installed
    __version__ = "0"

__all__ = ["Actuator", "FMICallException", "LogMessage", "SavedState", "Scene", "UnknownName", "frame", "packed_fmu"]

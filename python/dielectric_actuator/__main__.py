"""``python -m dielectric_actuator`` is the command ``dielectric-actuator``."""

import sys

from .command import main

sys.exit(main())

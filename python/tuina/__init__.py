# SPDX-License-Identifier: Apache-2.0
"""Robot massage: scans to acupoints, acupoints to plans, presses to tissue, and records of sessions.

SI units; places in the frame couch: x to the person's left, z up, metres. What goes wrong is a tuina.Error with
the sentence that the program says. tuina.simulation has a world without hardware.
"""
from tuina._tuina import *
from tuina._tuina import __version__ as __version__

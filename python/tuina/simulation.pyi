# SPDX-License-Identifier: Apache-2.0
from typing import Any, Callable, Literal

import numpy as np
import numpy.typing as npt

from tuina import Config, LabelledBody, Mapping, Plan, PointCloud, Presses, TissueEstimate

_Floats = npt.NDArray[np.float64]
_Command = Literal["pause", "resume", "stop", "skip", "repeat", "softer", "firmer"]

def person(
    person: str = "phantom:medium", position: Literal["sitting", "prone"] | None = None, seed: int = 1
) -> LabelledBody: ...
def scan(person: LabelledBody, seed: int = 1) -> PointCloud: ...
def presses(
    alpha_n: float, beta_per_m: float, world: str = "control", seed: int = 1
) -> tuple[Presses, Presses, int]: ...

class Contact:
    @property
    def path(self) -> str: ...
    @property
    def arm(self) -> Literal["left", "right"]: ...
    @property
    def begin_s(self) -> float: ...
    @property
    def end_s(self) -> float: ...
    @property
    def contact_fault(self) -> str: ...
    @property
    def whole(self) -> bool: ...
    @property
    def felt(self) -> TissueEstimate | None: ...

class Session:
    def to_json(self) -> str: ...
    @property
    def scan(self) -> PointCloud: ...
    @property
    def mapping(self) -> Mapping: ...
    @property
    def plan(self) -> Plan: ...
    @property
    def contacts(self) -> list[Contact]: ...
    @property
    def stops(self) -> list[str]: ...
    @property
    def massage_s(self) -> float: ...
    @property
    def acupoint_errors_m(self) -> _Floats: ...
    def trace(self, arm: Literal["left", "right"]) -> dict[str, Any]: ...

def massage(
    *,
    person: str = "phantom:medium",
    programme: str = "relax",
    position: Literal["sitting", "prone"] | None = None,
    robot: str = "thesis",
    method: Literal["surface", "field_morphing"] = "surface",
    seed: int = 1,
    config: Config = ...,
    adaptive: bool = True,
    atlas: str = "",
    no_go: str = "",
    out: str | None = None,
    on_contact: Callable[[Contact], _Command | None] | None = None,
) -> Session: ...

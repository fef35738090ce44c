"""The base of all models that a user writes."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, model_validator
from pydantic_core import PydanticCustomError

from garmentcad.errors import did_you_mean


class Model(BaseModel):
    """Base of all models: unknown keys are refused with the nearest one that is allowed."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True, frozen=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if isinstance(data, dict):
            allowed = {field.alias or name for name, field in cls.model_fields.items()}
            for key in data:
                if key not in allowed and key not in cls.model_fields:
                    raise PydanticCustomError("unknown_key", "unknown key{hint}", {"hint": did_you_mean(str(key), allowed), "key": str(key)})
        return data

    def _exactly_one(self, *names: str) -> None:
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) != 1:
            raise PydanticCustomError("one_of", "{message}", {"message": f"exactly one of {', '.join(names)} is wanted, came {', '.join(given) or 'none'}"})

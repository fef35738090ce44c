"""The materials of a job, laid out on its pattern."""

from __future__ import annotations

from garmentcad.cloth.lattice import MaterialOf
from garmentcad.cloth.materials import lay_out_sheets
from garmentcad.errors import SpecError
from garmentcad.fabric.material import MaterialTable
from garmentcad.simulation.job import Job


def lay_out(job: Job) -> tuple[MaterialTable, MaterialOf]:
    """As `lay_out_sheets`, of the job's pattern and fabrics. SpecError with the file of its spec."""
    try:
        return lay_out_sheets(job.pattern, {name: completed.sheet for name, completed in job.fabrics.items()})
    except SpecError as fault:
        raise SpecError(fault.message, file=job.spec.file, key=fault.key) from None

"""An acceleration as an answer: solved, traced, certified and put in a driver's words."""

from __future__ import annotations

from app.science.optimal.accelerate.certify import certify
from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.accelerate.solve import Solution, solve
from app.science.optimal.accelerate.trace import traced
from app.science.optimal.advice import advise
from app.science.optimal.answer import Answer
from app.science.optimal.fuel_checks import concavity
from app.science.optimal.problem import Accelerate, PolynomialEngine

WORTH_SAYING = 0.01


def answer(problem: Accelerate) -> Answer:
    """Solve a problem and say how one knows.

    Raises
    ------
    Infeasible
        When the speeds can't be reached, or not in the time that is given.
    """
    drive = drive_numbers(problem)
    solution = solve(problem)
    shown = traced(solution, drive)
    certificate = certify(problem, solution, drive, shown)
    return Answer(
        kind="accelerate",
        fuel_energy_j=solution.fuel_j,
        time_s=solution.time_s,
        distance_m=float(shown.trajectory.distance_m[-1]),
        gears=shown.gears,
        switch_speeds_mps=shown.switch_speeds_mps,
        multiplier_w=solution.mu_w,
        trajectory=shown.trajectory,
        costates={"speed": shown.costate},
        advice=advise(shown.trajectory),
        warnings=warnings(problem, solution),
        certificate=certificate,
    )


def warnings(problem: Accelerate, solution: Solution) -> tuple[str, ...]:
    """Return what a reader should know about the problem and the kind of its solution."""
    said = []
    concave = concavity(problem.engine)
    if concave is not None and concave.share > WORTH_SAYING:
        if isinstance(problem.engine, PolynomialEngine):
            where = (
                f"below {concave.below_nm:.0f} Nm"
                if concave.from_bottom
                else (f"between {concave.above_nm:.0f} and {concave.below_nm:.0f} Nm")
            )
            said.append(
                f"Fuel power is concave in torque in {100.0 * concave.share:.0f} % of the engine's field, {where}: "
                "there a steady torque takes more than a higher and a lower one in turn."
            )
        else:
            said.append("Fuel power is concave in wheel power: lowest and highest power in turn beat what is between.")
    stay = solution.linger
    if stay is not None and stay.cycle:
        v, power, held = stay.place.speed_mps, stay.place.fuel_w, stay.hold.fuel_w
        worse = f"holding the speed takes {held - power:.0f} W more" if held < float("inf") else "no control holds it"
        said.append(
            f"No classical optimum exists: about {v:.2f} m/s pulse and glide takes {power:.0f} W on average, {worse}. "
            f"The answer makes {stay.cycles} such cycles, between {v:.3f} and {stay.cycle[0].to_mps:.3f} m/s, and "
            f"burns {stay.fuel_j - power * stay.seconds:.3g} J more than infinitely many would."
        )
    if problem.transmission.shift_cost_j > 0.0 and (stay is not None or solution.slowing.phases):
        said.append("With charges for shifts, staying is looked for in one gear only, and slowing down once.")
    return tuple(said)

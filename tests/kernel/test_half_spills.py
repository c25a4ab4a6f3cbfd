"""Loops whose vectors LLVM spilled by half: of these systems the first step was off by 0.2 (without AVX-512)."""

import llvmlite.binding as llvm
import pytest

from canon import Hamiltonian, coordinates, parameters, propagate
from canon.flow import ExtendedPhaseSpace, SemiexplicitSplitting
from canon.kernel.llvm import loop
from canon.kernel.llvm.half_spills import may_spill_by_half
from canon.kernel.llvm.machine_code import compiled, optimized

x, y = coordinates("x y")
m, k = parameters("m k", positive=True)
p, q = x.momentum, y.momentum
START = [0.1, 0.2, 0.3, 0.1]


def stretched(stiffness):
    kinetic = p**2 / (2 * m) * (1 + y**2 / 4) + q**2 / 2
    return Hamiltonian(kinetic + stiffness * k * (x**2 + y**2) / 2, [x, y], [p, q])


@pytest.mark.parametrize("precision", ["double", "compensated", "extended"])
@pytest.mark.parametrize(
    "method", [SemiexplicitSplitting(4), SemiexplicitSplitting(6), ExtendedPhaseSpace(4, omega=20)]
)
@pytest.mark.parametrize("mass", [0.75, 1.0, 1.5])
def test_one_step_is_that_of_another_method(method, mass, precision):
    how = {"parameters": {m: mass, k: 1.25}, "samples": 1}
    found = propagate(stretched(1), (0, 0.05), START, method=method, step=0.05, precision=precision, **how)
    assert found.final == pytest.approx(propagate(stretched(1), (0, 0.05), START, **how).final, abs=1e-8)


def test_the_loop_that_was_spilled_by_half_is_made_without_parallel_scalars(monkeypatch):
    programs = []

    def seen(ir, *arguments):
        programs.append(ir)
        return compiled(ir, *arguments)

    monkeypatch.setattr(loop, "compiled", seen)
    propagate(  # a stiffness that no other test has, so that its loop is compiled here
        stretched(1.03125),
        (0, 0.05),
        START,
        method=SemiexplicitSplitting(4),
        step=0.05,
        precision="compensated",
        parameters={m: 1.0, k: 1.25},
        samples=1,
    )
    machine = _older_processor()
    if llvm.llvm_version_info >= (22, 0, 0):  # LLVM 20 makes no such vectors of it
        assert any(may_spill_by_half(str(_with_parallel_scalars(ir, machine))) for ir in programs)
    assert not any(may_spill_by_half(str(optimized(ir, machine))) for ir in programs)


def _older_processor():
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple("x86_64-unknown-linux-gnu")
    return target.create_target_machine(cpu="znver3", opt=3)


def _with_parallel_scalars(ir, machine):
    module = llvm.parse_assembly(ir)
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.loop_vectorization = tuning.loop_unrolling = tuning.slp_vectorization = True
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)
    return module


LOOP = """define void @f(ptr %y) {{
entry:
  %a = load <2 x double>, ptr %y
  %a0 = extractelement <2 x double> %a, i64 {first}
  br label %loop

loop:                                             ; preds = %entry, %loop
  %v = phi <2 x double> [ %a, %entry ], [ %b, %loop ]
  %s = phi double [ {number}, %entry ], [ 0.0, %loop ]
  %b = fadd <2 x double> %v, %v
  br label %{next}

end:
  %w = phi double [ %a0, %loop ]
  ret void
}}
"""


@pytest.mark.parametrize(
    ("first", "number", "found"),
    [(0, "%a0", True), (1, "%a0", False), (0, "1.0", False)],
    ids=["its first", "its second", "another"],
)
def test_which_pairs_are_found(first, number, found):
    assert may_spill_by_half(LOOP.format(first=first, number=number, next="loop")) is found


def test_names_of_another_function_are_its_own():
    taken = LOOP.format(first=0, number="1.0", next="loop")
    other = LOOP.format(first=1, number="%a0", next="loop").replace("@f", "@g")
    assert not may_spill_by_half(taken + other)

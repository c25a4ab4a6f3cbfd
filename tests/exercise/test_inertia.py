"""Products of inertia in Appell's function, against Lagrange's equations and against turned axes."""

import pytest

from canon import Lagrangian, coordinates, parameters
from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim
from canon.expression.parse import Scope, parse_expression

TENSOR = ["Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"]
MOMENTS = dict.fromkeys(TENSOR[:3], "positive") | dict.fromkeys(TENSOR[3:], "real")
FREE = {
    "q": ["a", "b", "c"],
    "quasi": ["u", "v", "w"],
    "q_dot": ["u", "v", "w"],
    "bodies": [{"I": TENSOR, "omega": ["u", "v", "w"]}],
    "parameters": MOMENTS,
}
EULER = [
    "Ixx*u_dot + Ixy*v_dot + Ixz*w_dot + v*(Ixz*u + Iyz*v + Izz*w) - w*(Ixy*u + Iyy*v + Iyz*w)",
    "Ixy*u_dot + Iyy*v_dot + Iyz*w_dot + w*(Ixx*u + Ixy*v + Ixz*w) - u*(Ixz*u + Iyz*v + Izz*w)",
    "Ixz*u_dot + Iyz*v_dot + Izz*w_dot + u*(Ixy*u + Iyy*v + Iyz*w) - v*(Ixx*u + Ixy*v + Ixz*w)",
]
ABOUT_X = {  # turned about the body's own x axis, which is fixed in space: ω = (φ̇, 0, 0)
    "q": ["phi"],
    "bodies": [{"I": TENSOR, "omega": ["phi_dot", "0", "0"]}],
    "V": "k*cos(phi)",
    "parameters": MOMENTS | {"k": "positive"},
}
TURNED = {  # by ψ about the vertical, then by θ about its own x axis: ω in axes of the body
    "q": ["psi", "theta"],
    "bodies": [{"I": TENSOR, "omega": ["theta_dot", "psi_dot*sin(theta)", "psi_dot*cos(theta)"]}],
    "parameters": MOMENTS,
}
T = (
    "(Ixx*theta_dot**2 + Iyy*psi_dot**2*sin(theta)**2 + Izz*psi_dot**2*cos(theta)**2)/2"
    " + Ixy*theta_dot*psi_dot*sin(theta) + Ixz*theta_dot*psi_dot*cos(theta)"
    " + Iyz*psi_dot**2*sin(theta)*cos(theta)"
)


def lagrange(T):
    """Return Lagrange's equations of T as text: a route that knows no Appell function."""
    q = coordinates("psi theta")
    names = {s.name: s for s in (*q, *parameters(" ".join(TENSOR) + ","))}
    return [str(equation) for equation in Lagrangian(parse_expression(T, Scope(names)), q).equations]


def appell(keys, **more):
    return judge(Claim("inertia", "gibbs-appell", {**keys, **more}))


def test_eulers_equations_with_products_of_inertia_and_their_wrong_twins():
    assert appell(FREE, claim=EULER).holds
    for i in range(3):
        wrong = [e.replace("Ixy", "(-Ixy)") if k == i else e for k, e in enumerate(EULER)]
        assert appell(FREE, claim=wrong).fails


def test_about_a_fixed_axis_one_moment_is_left():
    assert appell(ABOUT_X, claim=["Ixx*phi_ddot - k*sin(phi)"]).holds
    assert appell(ABOUT_X, claim=["(Ixx + Ixy)*phi_ddot - k*sin(phi)"]).fails


def test_appell_and_lagrange_agree_on_a_turned_body():
    assert appell(TURNED, claim=lagrange(T)).holds
    assert appell(TURNED, claim=lagrange(T.replace("Ixz*theta", "Iyz*theta"))).fails


@pytest.mark.parametrize("inertia", [TENSOR[:3], ["Ixx"]])
def test_principal_axes_are_the_tensor_without_products(inertia):
    few = {**FREE, "bodies": [{"I": inertia, "omega": ["u", "v", "w"]}]}
    claim = " ; ".join(EULER)
    for name, moment in zip(TENSOR, [*(inertia * 3)[:3], "0", "0", "0"], strict=True):
        claim = claim.replace(name, moment)
    assert appell(few, claim=claim.split(" ; ")).holds


def test_forces_without_potential_enter_by_the_velocities_that_they_work_with():
    """A blade driven by F forwards and braked in turning; the work of F on u is cos² + sin² = 1 times F u."""
    sleigh = {
        "q": ["x", "y", "theta"],
        "quasi": ["u", "w"],
        "q_dot": ["u*cos(theta)", "u*sin(theta)", "w"],
        "bodies": [{"m": "m", "r": ["x", "y"]}, {"I": "J", "omega": "w"}],
        "Qnc": ["F*cos(theta)", "F*sin(theta)", "-c*theta_dot"],
        "parameters": {"m": "positive", "J": "positive", "F": "real", "c": "positive"},
    }
    assert appell(sleigh, claim=["m*u_dot - F", "J*w_dot + c*w"]).holds
    assert appell(sleigh, claim=["m*u_dot - F", "J*w_dot - c*w"]).fails
    assert appell(sleigh, claim=["m*u_dot", "J*w_dot"]).fails

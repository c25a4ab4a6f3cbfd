r"""LaTeX read like the plain language: pairs, SymPy's own printing read back, conventions, errors, attacks."""

import subprocess
import sys
import time as clock

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import coordinates, parameters, time
from canon.expression.language import LanguageError, Scope, parse_condition, parse_equation, parse_expression
from canon.expression.symbol import Momentum

COORDINATES = "theta theta_1 theta2 phi x y q_1 q_2 r q_12"
PARAMETERS = "m m_1 m2 g l k a b c omega omega_0 alpha lambda A n m_eff x_bar M_s d_x delta_x"


def scope(extra="", functions=None, without=""):
    names = {s.name: s for s in coordinates(COORDINATES)}
    names |= {s.name: s for s in parameters(f"{PARAMETERS} {extra}")}
    names |= {name: Momentum(name, real=True) for name in ("p_theta", "p_x", "p_1", "p_theta_1")}
    for name in without.split():
        del names[name]
    declared = {"V": ("x",), "U": ("x", "y"), "rho": ("t",)} if functions is None else functions
    return Scope(names, declared)


SCOPE = scope()

PAIRS = [
    # names, products
    (r"2 m l \dot x", "2*m*l*x_dot"),
    (r"mgl\sin\theta", "m*g*l*sin(theta)"),
    (r"mgl(1-\cos\theta)", "m*g*l*(1 - cos(theta))"),
    (r"\ddot\theta + \frac{g}{l}\sin\theta", "theta_ddot + g/l*sin(theta)"),
    (r"0.5 k x^2", "k*x**2/2"),
    (r"a\cdot b \times c", "a*b*c"),
    (r"2\cdot 3", "6"),
    (r"- a - b + c", "-a - b + c"),
    (r"a - (-b)", "a + b"),
    (r"a\,b\;c\quad k\!m~g\ l", "a*b*c*k*m*g*l"),
    (r"\lambda \alpha", "lambda*alpha"),
    (r"\varphi", "phi"),
    (r"\ell", "l"),
    (r"m_{\text{eff}} + m_{\mathrm{eff}} + m_{eff}", "3*m_eff"),
    (r"\bar{x} + \bar x", "2*x_bar"),
    (r"\mathrm{m} g", "m*g"),
    (r"m_1m_2", "m_1*m2"),
    (r"M_s", "M_s"),
    (r"theta", "theta"),
    # subscripts and rates
    (r"q_1 + q_{12} + q_{1 2}", "q_1 + 2*q_12"),
    (r"\theta_1 + \theta_2", "theta_1 + theta2"),
    (r"\dot\theta_1 + \dot{\theta}_1 + \dot{\theta_1} + \dot{\theta_{1}}", "4*theta_1_dot"),
    (r"\ddot{q}_{1} + \ddot q_2", "q_1_ddot + q_2_ddot"),
    (r"\dot\theta_2^2", "theta2_dot**2"),
    (r"\dot\theta^2_2", "theta2_dot**2"),
    (r"p^2_\theta + p_{\theta}^{2}", "2*p_theta**2"),
    (r"p_{\theta_1}", "p_theta_1"),
    (r"\frac{p_x^2}{2m}", "p_x**2/(2*m)"),
    (r"x' + x'' + x^\prime + x^{\prime\prime}", "2*x_dot + 2*x_ddot"),
    (r"\theta_1' + \theta'_1", "2*theta_1_dot"),
    (r"\dot x\dot y", "x_dot*y_dot"),
    (r"\dot xy", "x_dot*y"),
    # fractions, roots, powers
    (r"\frac{a}{b} + \tfrac{a}{b} + \dfrac ab", "3*a/b"),
    (r"\frac12 m \dot x^2 + \frac1{2} k x^2 + \frac{1}2a", "m*x_dot**2/2 + k*x**2/2 + a/2"),
    (r"\sqrt{x^2+y^2}", "sqrt(x**2 + y**2)"),
    (r"\sqrt2 + \sqrt x", "sqrt(2) + sqrt(x)"),
    (r"\sqrt[3]{a}", "a**(1/3)"),
    (r"x^{n+1} + x^n", "x**(n+1) + x**n"),
    (r"x^{-1} + x^\frac12", "1/x + x**(1/2)"),
    (r"x^2y", "x**2*y"),
    (r"{x^a}^b", "(x**a)**b"),
    (r"a/b", "a/b"),
    (r"a/(bc)", "a/(b*c)"),
    (r"a/b\cdot c", "a/b*c"),
    (r"(a+b)(a-b)", "a**2 - b**2"),
    (r"\left(a+b\right)^2 + \bigl[a\bigr] + \{b\}", "(a+b)**2 + a + b"),
    (r"\left\{a+b\right\}c", "(a+b)*c"),
    # functions
    (r"\sin^2\theta + \cos^{2}\theta", "sin(theta)**2 + cos(theta)**2"),
    (r"\sin 2\theta", "sin(2*theta)"),
    (r"\sin(2\theta)", "sin(2*theta)"),
    (r"\sin{2\theta}", "sin(2*theta)"),
    (r"\cos(\theta_1-\theta_2)", "cos(theta_1 - theta2)"),
    (r"\sin\theta\cos\theta", "sin(theta)*cos(theta)"),
    (r"\sin 2\theta\cos\omega t", "sin(2*theta)*cos(omega*t)"),
    (r"\cos\omega_0 t", "cos(omega_0*t)"),
    (r"\cos\sqrt{\frac{k}{m}}t", "cos(sqrt(k/m)*t)"),
    (r"\sin ab + c", "sin(a*b) + c"),
    (r"\sin\tfrac12(\theta-\phi)", "sin((theta - phi)/2)"),
    (r"\sin\pi\,x", "sin(pi*x)"),
    (r"\sin(a)b", "sin(a)*b"),
    (r"\sin(a)^2", "sin(a)**2"),
    (r"\sin\theta\cdot\dot\theta", "sin(theta)*theta_dot"),
    (r"\cot^{-1} x + \tan^{-1}x + \arctan x + \arcsin\frac{x}{a}", "acot(x) + 2*atan(x) + asin(x/a)"),
    (r"\cosh^{-1}(a)", "acosh(a)"),
    (r"\ln a + \log a + \log_{10} a + \log_2 a", "2*log(a) + log(a)/log(10) + log(a)/log(2)"),
    (r"\ln\sin x", "log(sin(x))"),
    (r"\exp(-kt)", "exp(-k*t)"),
    (r"A e^{-kt}", "A*exp(-k*t)"),
    (r"Ae^x", "A*exp(x)"),
    (r"\mathrm{e}^{a}", "exp(a)"),
    (r"\sinh x\cosh x\tanh x", "sinh(x)*cosh(x)*tanh(x)"),
    (r"\coth x", "1/tanh(x)"),
    (r"\sec\theta\csc\theta", "sec(theta)*csc(theta)"),
    (r"|x| + \left|y\right| + \lvert x-y\rvert", "Abs(x) + Abs(y) + Abs(x-y)"),
    (r"\max(a, b) + \operatorname{atan}_2(y, x)", "Max(a, b) + atan2(y, x)"),
    (r"\operatorname{sgn}x + \operatorname{arsinh}(x)", "sign(x) + asinh(x)"),
    (r"2\pi r", "2*pi*r"),
    (r"\mathrm{i} x", "I*x"),
    # derivatives and functions
    (r"m\ddot x + V'(x)", "m*x_ddot + Derivative(V(x), x)"),
    (r"V(x) + V(a+b)^2 + V^2(x)", "V(x) + V(a+b)**2 + V(x)**2"),
    (r"V''(x)", "Derivative(V(x), (x, 2))"),
    (r"\frac{dV}{dx} + \frac{d V(x)}{d x} + \frac{d}{dx}V(x)", "3*Derivative(V(x), x)"),
    (r"\frac{\mathrm{d}V}{\mathrm{d}x}", "Derivative(V(x), x)"),
    (r"\frac{d^2V}{dx^2}", "Derivative(V(x), (x, 2))"),
    (r"\frac{\partial U}{\partial x}", "Derivative(U(x, y), x)"),
    (r"\frac{\partial^2 U}{\partial x\partial y}", "Derivative(U(x, y), x, y)"),
    (r"\frac{\partial^3 U(x,y)}{\partial x^2\partial y}", "Derivative(U(x, y), (x, 2), y)"),
    (r"\frac{\partial}{\partial x}(x^2 y)", "2*x*y"),
    (r"\frac{\partial (m\dot x^2)}{\partial\dot x}", "2*m*x_dot"),
    (r"\frac{d\theta}{dt} + \frac{d^2\theta_1}{dt^2}", "theta_dot + theta_1_ddot"),
    (r"\dot\rho + \dot\rho(t) + \rho'(t) + \frac{d\rho}{dt}", "4*Derivative(rho(t), t)"),
    (r"dx + \delta x\,d_x", "d_x + delta_x*d_x"),
    (r"$a+b$", "a+b"),
]  # fmt: skip


@pytest.mark.parametrize(("latex", "plain"), [pair for pair in PAIRS if pair[1]])
@pytest.mark.parametrize("closing", ["", "$"])
def test_latex_reads_like_its_plain_spelling(latex, plain, closing):
    expected = parse_expression(plain, SCOPE)
    opening = "$"
    if latex.startswith("$"):
        opening, closing = "$", "$"
        latex = latex[1:-1]
    found = parse_expression(f"{opening}{latex}{closing}", SCOPE)
    assert sp.expand(found - expected) == 0

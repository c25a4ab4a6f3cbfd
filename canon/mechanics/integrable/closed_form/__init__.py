"""Actions and angles of separated systems in closed form, each certified against quadrature."""

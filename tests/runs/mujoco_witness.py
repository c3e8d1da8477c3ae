"""The four-bar of the scenes as MuJoCo's model: the same mechanism in an engine that is not ours.

MuJoCo's constraint reference is aref = -b cdot - k c, Baumgarte's feedback, with k and b given as solref = (-k, -b)
(MuJoCo documentation, Modeling, Constraint parameters). Its Euler integrator is symplectic Euler, its RK4 Kutta's.
"""

from bezstab.units import feedback_gains


def four_bar_xml(integrator: str, h: float, alpha_hat: float, beta_hat: float) -> str:
    """Return configs/scenes/four_bar.toml as MuJoCo's XML: joints are the scene's coordinates.

    Without gravity; inertias are about the centres of mass. h in s.
    """
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    # the rest of the unconstrained acceleration leaks into the constraint: so hard an impedance as there is
    feedback = f'solref="{-beta_squared!r} {-two_alpha!r}" solimp="0.9999 0.9999 1 0.5 1"'
    return f"""<mujoco>
        <option timestep="{h!r}" integrator="{integrator}" gravity="0 0 0" tolerance="0" iterations="100">
          <flag contact="disable" refsafe="disable" autoreset="disable"/>
        </option>
        <default><joint axis="0 0 1"/></default>
        <worldbody>
          <body><inertial pos=".05 0 0" mass=".2" diaginertia="1 1 {0.2 * 0.1**2 / 12!r}"/>
            <joint/><site name="crank's end" pos=".1 0 0"/></body>
          <body><inertial pos="0 0 0" mass=".6" diaginertia="1 1 .0045"/>
            <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint/>
            <site name="coupler's start" pos="-.15 0 0"/><site name="coupler's end" pos=".15 0 0"/></body>
          <body pos=".3 0 0"><inertial pos=".125 0 0" mass=".5" diaginertia="1 1 {0.5 * 0.25**2 / 12!r}"/>
            <joint/><site name="rocker's end" pos=".25 0 0"/></body>
        </worldbody>
        <equality><connect site1="crank's end" site2="coupler's start" {feedback}/>
          <connect site1="coupler's end" site2="rocker's end" {feedback}/></equality>
    </mujoco>"""

// Runs matter.js, cannon-es or p2: bodies in a straight line, each held by a distance constraint to the one before.
// Reads {engine, h, steps, stiffness, ...} from standard input, prints by how much each link is too long, step by step.
// With {balls} they are balls of that diameter, stacked on a plane: how far each gap is from its diameter.
// With {spin} the only body goes round at that rate (rad/s), and its angle is printed in place of that.
"use strict";

global.P2_ARRAY_TYPE = Array; // float64
const LENGTH = 1;

function inMatter({ h, stiffness, iterations, places, spin, gravity = 0 }) {
  const Matter = require("matter-js");
  const engine = Matter.Engine.create({ constraintIterations: iterations });
  engine.gravity = { x: 1, y: 0, scale: gravity / 1e6 }; // its time is in ms
  const bodies = places.map((x) => Matter.Bodies.circle(x, 0, 0.1, { frictionAir: 0, collisionFilter: { mask: 0 } }));
  bodies.forEach((bodyB, i) => {
    const held = i ? { bodyA: bodies[i - 1] } : { pointA: { x: 0, y: 0 } };
    Matter.Composite.add(engine.world, [bodyB, Matter.Constraint.create({ ...held, bodyB, length: LENGTH, stiffness })]);
  });
  const step = () => Matter.Engine.update(engine, 1000 * h);
  if (!spin) return [step, () => bodies.map((body) => body.position.x)];
  Matter.Body.setVelocity(bodies[0], { x: 0, y: spin * LENGTH * Matter.Body._baseDelta / 1000 });
  return [step, () => [Math.atan2(bodies[0].position.y, bodies[0].position.x)]];
}

function inCannon({ h, stiffness, relaxation, timeStep, iterations, masses, places, velocities, gravity = 0 }) {
  const CANNON = require("cannon-es");
  const world = new CANNON.World({ gravity: new CANNON.Vec3(gravity, 0, 0) });
  world.solver.iterations = iterations;
  world.solver.tolerance = 0;
  let before = new CANNON.Body({ mass: 0 });
  world.addBody(before);
  const bodies = places.map((x, i) => {
    const body = new CANNON.Body({ mass: masses[i], position: new CANNON.Vec3(x, 0, 0), linearDamping: 0 });
    body.velocity.set(velocities[i], 0, 0);
    world.addBody(body);
    const held = new CANNON.DistanceConstraint(before, body, LENGTH);
    // without a step of its own what it was made with stays: 1/60 s
    if (stiffness) held.equations[0].setSpookParams(stiffness, relaxation, timeStep);
    world.addConstraint(held);
    before = body;
    return body;
  });
  return [() => world.step(h), () => bodies.map((body) => body.position.x)];
}

function ballsInCannon({ h, iterations, masses, velocities, gravity }) {
  const CANNON = require("cannon-es");
  const world = new CANNON.World({ gravity: new CANNON.Vec3(0, 0, -gravity) });
  world.solver.iterations = iterations;
  world.solver.tolerance = 0;
  Object.assign(world.defaultContactMaterial, { friction: 0, restitution: 0 });
  world.addBody(new CANNON.Body({ mass: 0, shape: new CANNON.Plane() }));
  const shape = new CANNON.Sphere(LENGTH / 2);
  const bodies = masses.map((mass, i) => {
    const position = new CANNON.Vec3(0, 0, LENGTH * (i + 0.5));
    return new CANNON.Body({ mass, shape, position, linearDamping: 0, fixedRotation: true });
  });
  bodies.forEach((body, i) => {
    body.velocity.z = velocities[i];
    world.addBody(body);
  });
  return [() => world.step(h), () => bodies.map((body) => body.position.z + LENGTH / 2)];
}

function inP2({ h, stiffness, relaxation, iterations, masses, places, velocities, gravity = 0 }) {
  const p2 = require("p2");
  const world = new p2.World({ gravity: [gravity, 0] });
  world.solver.iterations = iterations;
  world.solver.tolerance = 0;
  world.applyDamping = false;
  let before = new p2.Body({ mass: 0 });
  world.addBody(before);
  const bodies = places.map((x, i) => {
    const body = new p2.Body({ mass: masses[i], position: [x, 0], velocity: [velocities[i], 0] });
    world.addBody(body);
    const held = new p2.DistanceConstraint(before, body, { distance: LENGTH });
    if (stiffness) {
      held.setStiffness(stiffness);
      held.setRelaxation(relaxation);
    }
    world.addConstraint(held);
    before = body;
    return body;
  });
  return [() => world.step(h), () => bodies.map((body) => body.position[0])];
}

const asked = JSON.parse(require("fs").readFileSync(0, "utf8"));
const [step, places] = { "matter.js": inMatter, "cannon-es": asked.balls ? ballsInCannon : inCannon, p2: inP2 }[asked.engine](asked);
const errors = () => places().map((x, i, all) => x - (i ? all[i - 1] : 0) - LENGTH);
const look = asked.spin ? places : errors;
const seen = [look()];
for (let count = 0; count < asked.steps; count += 1) {
  step();
  seen.push(look());
}
console.log(JSON.stringify(seen));

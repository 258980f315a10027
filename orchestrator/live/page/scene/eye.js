// The camera: turned by hand, or moved to fit all agents, to look from above, to keep up with one agent.
import {Vector3} from "/vendor/three/build/three.module.js";
import {OrbitControls} from "/vendor/three/examples/jsm/controls/OrbitControls.js";

const MOVE_MS = 350;
const FILLED = 0.78;  // part of the picture that points may fill
const ROOM_M = 0.4;   // around each of them
const LEAST_DISTANCE_M = 4;
const FIRST_LOOK = new Vector3(0.35, -1, 0.72);
const FROM_ABOVE = new Vector3(0, -1e-4, 1);

const wantsStillness = matchMedia("(prefers-reduced-motion: reduce)");

export class Eye {
  #camera;
  #controls;
  #move = null;   // {from, to, since}: places of camera and target
  #followed = 0;  // number of an agent
  #last = null;   // where it was

  constructor(camera, canvas, onChange) {
    this.#camera = camera;
    this.#controls = new OrbitControls(camera, canvas);
    Object.assign(this.#controls, {
      enableKeys: false,
      enableDamping: false,
      rotateSpeed: 0.7,
      maxPolarAngle: 0.95 * Math.PI,
      minDistance: 0.3,
      maxDistance: 1e5
    });
    this.#controls.addEventListener("change", onChange);
    this.#controls.addEventListener("start", () => {
      this.#move = null;
    });
    camera.position.copy(FIRST_LOOK).multiplyScalar(12);
    this.#controls.update();
  }

  get target() { return this.#controls.target; }
  get followed() { return this.#followed; }
  distance() { return this.#camera.position.distanceTo(this.target); }

  /** Lets a drag turn the camera, or not. */
  set free(free) { this.#controls.enabled = free; }

  follow(number) {
    this.#followed = number;
    this.#last = null;
  }

  keepUp({p}, isNew) {
    if (!this.#followed || !isNew) return;
    const now = new Vector3().fromArray(p, 3 * (this.#followed - 1));
    if (this.#last)
      this.#shift(now.clone().sub(this.#last));
    else
      this.#goTo(now, this.#camera.position.clone().sub(this.target).add(now));
    this.#last = now;
  }

  #shift(by) {
    this.#camera.position.add(by);
    this.target.add(by);
    if (this.#move)
      for (const place of [...this.#move.from, ...this.#move.to]) place.add(by);
    this.#controls.update();
  }

  /** Looks at all points, from where it looks now. */
  fit(points, isFirst = false) {
    const way = isFirst ? FIRST_LOOK : this.#camera.position.clone().sub(this.target);
    this.#lookAt(points, way, isFirst);
  }

  fromAbove(points) { this.#lookAt(points, FROM_ABOVE); }

  #lookAt(points, way, atOnce = false) {
    this.follow(0);
    const middle = middleOf(points);
    this.#goTo(middle, way.clone().setLength(this.#distanceFor(points, middle, way)).add(middle), atOnce);
  }

  // How far from the middle the camera sees all points, with some room around them.
  #distanceFor(points, middle, way) {
    const towards = way.clone().normalize(), right = this.#camera.up.clone().cross(towards).normalize(),
          up = towards.clone().cross(right);
    const half = FILLED * Math.tan(this.#camera.fov * Math.PI / 360), from = new Vector3();
    return points.reduce((most, [x, y, z]) => {
      from.set(x, y, z).sub(middle);
      const sideways = (Math.abs(from.dot(right)) + ROOM_M) / (half * this.#camera.aspect),
            upwards = (Math.abs(from.dot(up)) + ROOM_M) / half;
      return Math.max(most, from.dot(towards) + Math.max(sideways, upwards));
    }, LEAST_DISTANCE_M);
  }

  #goTo(target, place, atOnce = false) {
    this.#move = {from: [this.target.clone(), this.#camera.position.clone()], to: [target.clone(), place], since: null};
    if (atOnce || wantsStillness.matches) this.#moveTo(1);
  }

  #moveTo(share) {
    const {from, to} = this.#move, s = share * share * (3 - 2 * share);
    this.target.lerpVectors(from[0], to[0], s);
    this.#camera.position.lerpVectors(from[1], to[1], s);
    this.#controls.update();
    if (share >= 1) this.#move = null;
  }

  /** Goes on with a move. Returns true if the camera has moved. */
  update(now_ms) {
    if (!this.#move) return false;
    this.#move.since = this.#move.since ?? now_ms;
    this.#moveTo(Math.min(1, (now_ms - this.#move.since) / MOVE_MS));
    return true;
  }
}

/** The middle of the box around some points. */
function middleOf(points) {
  if (points.length === 0) return new Vector3();
  const low = new Vector3(Infinity, Infinity, Infinity), high = new Vector3(-Infinity, -Infinity, -Infinity);
  for (const [x, y, z] of points) {
    const point = new Vector3(x, y, z);
    low.min(point);
    high.max(point);
  }
  return low.add(high).multiplyScalar(0.5);
}

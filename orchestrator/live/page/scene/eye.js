// The camera: turned by hand, or moved to fit all agents, to look from above, to keep up with one agent. It sees in
// perspective, but for a view from above, which is flat: where an agent is on the grid does not depend on its height.
import {Vector3} from "/vendor/three/build/three.module.js";
import {OrbitControls} from "/vendor/three/examples/jsm/controls/OrbitControls.js";

const MOVE_MS = 350;
const FILLED = 0.78;  // part of the picture that points may fill
const ROOM_M = 0.4;   // around each of them
const LEAST_DISTANCE_M = 4;
const UP = new Vector3(0, 0, 1);
const FIRST_LOOK = new Vector3(0.35, -1, 0.72);
const FROM_ABOVE = new Vector3(0, -1e-4, 1);
const FIELD_DEG = 40, FLAT_FIELD_DEG = 1;
const FLAT_TILT_DEG = 1, DEEP_TILT_DEG = 15;  // from the vertical: flat below, in full perspective above

const wantsStillness = matchMedia("(prefers-reduced-motion: reduce)");

/** The tangent of half a field of view. */
const halfOf = (degrees) => Math.tan(degrees * Math.PI / 360);
const FULL_HALF = halfOf(FIELD_DEG);

/** From 0 to 1 as x goes there, slowly at both ends. */
const smooth = (x) => x * x * (3 - 2 * x);

/** The field of view, in degrees, of a camera to which `way` leads from what it looks at. */
function fieldFor(way) {
  const tilt_deg = way.angleTo(UP) * 180 / Math.PI,
        share = Math.max(0, Math.min(1, (tilt_deg - FLAT_TILT_DEG) / (DEEP_TILT_DEG - FLAT_TILT_DEG)));
  return FLAT_FIELD_DEG + (FIELD_DEG - FLAT_FIELD_DEG) * smooth(share);
}

export class Eye {
  #camera;
  #controls;
  #move = null;   // {from, to, since}: targets, and ways from them to the camera in full perspective
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
    this.#controls.addEventListener("change", () => {
      this.#flatten();
      onChange();
    });
    this.#controls.addEventListener("start", () => {
      this.#move = null;
    });
    camera.fov = FIELD_DEG;
    camera.position.copy(FIRST_LOOK).multiplyScalar(12);
    this.#controls.update();
  }

  get target() { return this.#controls.target; }
  get followed() { return this.#followed; }

  /** From what it looks at to the camera; to where the camera would see as much in full perspective. */
  get #way() { return this.#camera.position.clone().sub(this.target); }
  get #fullWay() { return this.#way.multiplyScalar(halfOf(this.#camera.fov) / FULL_HALF); }
  cameraDistance() { return this.#way.length(); }
  distance() { return this.#fullWay.length(); }

  /** How much the picture's height shows at the place that it looks at. */
  get span_m() { return 2 * FULL_HALF * this.distance(); }

  /** Gives the camera the field of view for where it is, and moves it so that it sees as much as before. */
  #flatten() {
    const way = this.#fullWay, field = fieldFor(way);
    if (field === this.#camera.fov) return;
    this.#camera.fov = field;
    this.#camera.position.copy(way.multiplyScalar(FULL_HALF / halfOf(field)).add(this.target));
  }

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
      this.#goTo(now, this.#fullWay);
    this.#last = now;
  }

  #shift(by) {
    this.#camera.position.add(by);
    this.target.add(by);
    if (this.#move)
      for (const {target} of [this.#move.from, this.#move.to]) target.add(by);
    this.#controls.update();
  }

  /** Looks at all points, from where it looks now. */
  fit(points, isFirst = false) { this.#lookAt(points, isFirst ? FIRST_LOOK : this.#fullWay, isFirst); }

  fromAbove(points) { this.#lookAt(points, FROM_ABOVE); }

  #lookAt(points, way, atOnce = false) {
    this.follow(0);
    const middle = middleOf(points);
    this.#goTo(middle, way.clone().setLength(this.#distanceFor(points, middle, way)), atOnce);
  }

  // How far from the middle the camera sees all points in full perspective, with some room around them.
  #distanceFor(points, middle, way) {
    const towards = way.clone().normalize(), right = this.#camera.up.clone().cross(towards).normalize(),
          up = towards.clone().cross(right);
    const half_now = halfOf(fieldFor(way)), half = FILLED * half_now, from = new Vector3();
    const distance = points.reduce((most, [x, y, z]) => {
      from.set(x, y, z).sub(middle);
      const sideways = (Math.abs(from.dot(right)) + ROOM_M) / (half * this.#camera.aspect),
            upwards = (Math.abs(from.dot(up)) + ROOM_M) / half;
      return Math.max(most, from.dot(towards) + Math.max(sideways, upwards));
    }, 0);
    return Math.max(LEAST_DISTANCE_M, distance * half_now / FULL_HALF);
  }

  // `way`: from the target to the camera, in full perspective.
  #goTo(target, way, atOnce = false) {
    this.#move = {
      from: {target: this.target.clone(), way: this.#fullWay},
      to: {target: target.clone(), way},
      since: null
    };
    if (atOnce || wantsStillness.matches) this.#moveTo(1);
  }

  #moveTo(share) {
    const {from, to} = this.#move, s = smooth(share);
    this.target.lerpVectors(from.target, to.target, s);
    const way = new Vector3().lerpVectors(from.way, to.way, s);
    this.#camera.position.copy(way.multiplyScalar(FULL_HALF / halfOf(this.#camera.fov)).add(this.target));
    this.#flatten();
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

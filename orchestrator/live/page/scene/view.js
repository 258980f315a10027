// The view: one WebGL canvas with its layers, and a canvas above it for texts and marks. It draws only when something
// has changed.
import {Color, DirectionalLight, HemisphereLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer} from "/vendor/three/build/three.module.js";

import {styleColour} from "../colours.js";

import {Cells, Hulls} from "./areas.js";
import {Arrows, Plumbs, Tree} from "./arrows.js";
import {Bodies} from "./bodies.js";
import {Edges} from "./edges.js";
import {Eye} from "./eye.js";
import {Ground} from "./ground.js";
import {Obstacles, WaypointPaths} from "./marks.js";
import {Overlay, places} from "./overlay.js";
import {setViewport} from "./ribbons.js";
import {Trails} from "./trails.js";

const MOST_PLUMBS = 200;
const MOST_PIXEL_RATIO = 2;

/** What is shown until the viewer says otherwise. */
const SHOWN = {
  trails: true,
  edges: true,
  velocity: false,
  acceleration: false,
  numbers: true,
  tree: true,
  cells: true,
  hulls: true,
  liars: true,
  lost: true,
  leftOut: true,
  plan: true,
  heights: true
};

export class View {
  #model;
  #renderer;
  #overlay;
  #scene = new Scene();
  #camera = new PerspectiveCamera();
  #ground = new Ground();
  #stale = true;    // something has changed since the last picture
  #newRow = false;  // a row has come since
  #place = new Vector3();
  #isFitted = false;   // to the first row of the run
  #wasInView = false;  // an agent, in the picture before
  #lastFrame = null;   // that was drawn
  layers = {};         // by name; rebuilt for each run
  shown = {...SHOWN};
  renders = 0;
  screen = new Float32Array(0);  // x, y (px) and depth of each agent; depth > 1: behind the camera
  pointed = {agent: 0, edge: -1};
  ghost = null;  // where an agent is being sent: {agent, p}

  constructor(canvas, overlay, model) {
    this.#model = model;
    this.canvas = canvas;
    this.#renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.#camera.up.set(0, 0, 1);
    this.eye = new Eye(this.#camera, canvas, () => this.touch());
    this.#overlay = new Overlay(overlay, this);
    const sun = new DirectionalLight(0xffffff, 0.55);
    sun.position.set(-0.5, -0.8, 1.6);
    this.#scene.add(this.#ground, new HemisphereLight(0xffffff, 0x8c96a0, 0.75), sun);
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
    model.on("run", () => this.#build());
    model.on("experiment", () => this.#rebuildMarks());
    model.on("frame", () => {
      this.#newRow = true;
    });
    model.on("selected", () => this.takeAgain());
    for (const kind of ["events", "connection"]) model.on(kind, () => this.touch());
    this.paint();
  }

  get camera() { return this.#camera; }
  get model() { return this.#model; }
  get ground() { return this.#ground; }
  get texts() { return this.#overlay.texts; }

  /** Says that the picture is no longer right. */
  touch() { this.#stale = true; }

  /** Says that the layers must look at the row again. */
  takeAgain() { this.#newRow = true; }

  show(name, visible) {
    this.shown[name] = visible;
    if (this.layers[name]) this.layers[name].visible = visible;
    this.takeAgain();
  }

  /** Colours as the style sheet has them now. */
  paint() {
    this.#ground.paint();
    for (const layer of Object.values(this.layers)) (layer.paintAll ?? layer.paint)?.call(layer);
    this.#newRow = true;
    this.touch();
  }

  // --- layers ---

  #build() {
    const {agents, edges} = this.#model.experiment, size = agents.length;
    this.#replace("bodies", new Bodies(agents));
    this.#replace("trails", new Trails(size));
    this.#replace("edges", new Edges(edges));
    this.#replace("heights", size <= MOST_PLUMBS ? new Plumbs(size) : null);
    this.#replace("velocity", new Arrows(size, "v", "velocity"));
    this.#replace("acceleration", new Arrows(size, "a", "acceleration"));
    this.screen = new Float32Array(3 * size);
    this.pointed = {agent: 0, edge: -1};
    this.ghost = null;
    this.eye.follow(0);
    this.#isFitted = false;
    this.#resize();
  }

  #rebuildMarks() {
    const {agents, obstacles, cells, hulls} = this.#model.experiment;
    this.#replace("tree", new Tree(agents));
    this.#replace("cells", cells.length > 0 ? new Cells(cells, agents.length) : null);
    this.#replace("hulls", hulls.length > 0 ? new Hulls(hulls) : null);
    this.#replace("obstacles", new Obstacles(obstacles));
    this.#replace("plan", new WaypointPaths(agents));
    this.layers.bodies.setLost(this.#model.lost);
    this.#newRow = true;
  }

  #replace(name, layer) {
    if (this.layers[name]) {
      this.#scene.remove(this.layers[name]);
      this.layers[name].dispose();
    }
    delete this.layers[name];
    if (!layer) return;
    layer.visible = this.shown[name] ?? true;
    this.layers[name] = layer;
    this.#scene.add(layer);
  }

  // --- pictures ---

  #resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(devicePixelRatio, MOST_PIXEL_RATIO);
    this.#renderer.setPixelRatio(ratio);
    this.#renderer.setSize(width, height, false);
    this.#overlay.resize(width, height, ratio);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    setViewport(width, height);
    this.layers.bodies?.setViewport(height, ratio);
    this.#newRow = true;
    this.touch();
  }

  /** To be called before each picture of the screen. */
  draw(now_ms) {
    const {frame} = this.#model;
    if (frame && !this.#isFitted) this.#firstLook();
    if (frame) this.eye.keepUp(frame, this.#newRow);
    const moved = this.eye.update(now_ms);
    if (frame && this.#newRow) this.#takeRow(frame);
    if (moved || this.#stale) this.#render(frame);
    if (frame) this.#keepInView(frame !== this.#lastFrame && !moved);
    this.#lastFrame = frame;
  }

  // A team that leaves the picture by its own motion, or by a jump in time, is looked at again; one from which somebody
  // has turned the eye away is not.
  #keepInView(mayLeave) {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    let inView = false;
    for (let k = 0; k < this.screen.length && !inView; k += 3) {
      const [x, y, depth] = this.screen.subarray(k, k + 3);
      inView = depth <= 1 && x >= 0 && x <= width && y >= 0 && y <= height;
    }
    if (mayLeave && this.#wasInView && !inView) this.fit();
    this.#wasInView = inView;
  }

  #firstLook() {
    this.#isFitted = true;
    this.eye.fit(this.#points(), true);
  }

  #takeRow(frame) {
    const {pointed, layers} = this, {selected} = this.#model;
    this.#newRow = false;
    this.touch();
    for (const [name, layer] of Object.entries(layers)) {
      if (name !== "edges" && layer.update) layer.update(frame);
    }
    this.#newRow = layers.edges.visible &&
        layers.edges.update(
            frame, {pointed: pointed.edge, selected, radius: layers.bodies.radius_m, showsLeftOut: this.shown.leftOut});
  }

  #render(frame) {
    this.#stale = false;
    ++this.renders;
    const distance = this.eye.cameraDistance();
    this.#camera.near = distance / 100;
    this.#camera.far = 20 * distance;
    this.#camera.updateProjectionMatrix();
    this.#ground.fit(this.eye.target, this.eye.distance());
    this.layers.bodies?.setScale(this.pxPerM());
    this.#renderer.setClearColor(new Color(styleColour("stage")), 1);
    this.#renderer.render(this.#scene, this.#camera);
    if (frame) this.#project(frame.p);
    this.#overlay.draw(frame);
  }

  #project(p) {
    for (let k = 0; k < p.length; k += 3) this.screen.set(this.toScreen([p[k], p[k + 1], p[k + 2]]), k);
  }

  /** x, y (px) and depth of a point; depth > 1: behind the camera. */
  toScreen([x, y, z]) {
    const place = this.#place.set(x, y, z).project(this.#camera);
    return [(place.x + 1) / 2 * this.canvas.clientWidth, (1 - place.y) / 2 * this.canvas.clientHeight, place.z];
  }

  /** Pixels of a metre at the place that the camera looks at. */
  pxPerM() { return this.canvas.clientHeight / this.eye.span_m; }

  /** Pixels of the radius of an agent's body. */
  radiusPx(number) {
    const {p} = this.#model.frame, camera = this.#camera;
    const depth_m = -this.#place.fromArray(p, 3 * (number - 1)).applyMatrix4(camera.matrixWorldInverse).z;
    return this.layers.bodies.radii_m[number - 1] * camera.projectionMatrix.elements[5] * this.canvas.clientHeight /
        (2 * depth_m);
  }

  // --- looking ---

  fit() { this.eye.fit(this.#points()); }
  top() { this.eye.fromAbove(this.#points()); }

  #points() {
    const {frame, experiment} = this.#model, points = [];
    for (let k = 0; k < (frame?.p.length ?? 0); k += 3) points.push(frame.p.slice(k, k + 3));
    if (frame) points.push(...places(experiment?.agents ?? [], frame.p).map(([place]) => place));
    for (const {waypoints_m} of experiment?.agents ?? []) points.push(...(waypoints_m ?? []));
    for (const {position_m} of experiment?.obstacles ?? []) points.push(position_m);
    for (const {region_m} of experiment?.cells ?? []) points.push(...region_m.map(([x, y]) => [x, y, 0]));
    if (experiment?.prediction?.value_m) points.push(experiment.prediction.value_m);
    return points;
  }

  /** The picture as it is now, as ImageData: for tests. */
  pixels() {
    this.#render(this.#model.frame);
    const copy = document.createElement("canvas");
    Object.assign(copy, {width: this.canvas.width, height: this.canvas.height});
    const pen = copy.getContext("2d");
    pen.drawImage(this.canvas, 0, 0);
    return pen.getImageData(0, 0, copy.width, copy.height);
  }
}

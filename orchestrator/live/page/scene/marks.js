// What does not move: obstacles, and the ways between waypoints. Marks of constant size are drawn by the overlay.
import {BoxBufferGeometry, CylinderBufferGeometry, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, SphereBufferGeometry} from "/vendor/three/build/three.module.js";

import {agentColours, rgb, styleColour} from "../colours.js";

import {Ribbons} from "./ribbons.js";

const SHAPES = {
  box: () => new BoxBufferGeometry(1, 1, 1),
  sphere: () => new SphereBufferGeometry(0.5, 28, 18),
  cylinder: () => new CylinderBufferGeometry(0.5, 0.5, 1, 36).rotateX(Math.PI / 2),
};

export class Obstacles extends Group {
  #solid = new MeshLambertMaterial({transparent: true, opacity: 0.78});
  #outline = new LineBasicMaterial();

  constructor(obstacles) {
    super();
    for (const {kind, position_m, size_m, heading_rad = 0} of obstacles) {
      const geometry = SHAPES[kind](), body = new Mesh(geometry, this.#solid);
      body.position.set(...position_m);
      body.rotation.z = heading_rad;
      body.scale.set(...size_m);
      if (kind !== "sphere") body.add(new LineSegments(new EdgesGeometry(geometry, 30), this.#outline));
      this.add(body);
    }
    this.paint();
  }

  paint() {
    this.#solid.color.set(styleColour("solid"));
    this.#outline.color.set(styleColour("grid"));
  }

  dispose() {
    this.traverse((part) => part.geometry?.dispose());
    this.#solid.dispose();
    this.#outline.dispose();
  }
}

/** Lines from waypoint to waypoint, in the colour of the agent that flies them. */
export class WaypointPaths extends Ribbons {
  constructor(agents) {
    const lines = agents.flatMap(
        ({id, waypoints_m}) => (waypoints_m ?? []).slice(1).map((to, k) => ({id, from: waypoints_m[k], to})));
    super(Math.max(1, lines.length), {order: 0, trim: 7});
    this.lines = lines;
    this.size = agents.length;
    this.count = lines.length;
    lines.forEach(({from, to}, k) => {
      this.place(k, from, 0, to, 0);
      this.shape(k, 1.4, 0, 5);
    });
    this.paintAll();
  }

  paintAll() {
    const colours = agentColours(this.size);
    this.lines.forEach(({id}, k) => this.paint(k, rgb(colours[id - 1]), 0.6));
    this.send(["start", "end", "form", "tint"]);
  }
}

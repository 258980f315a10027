// Areas that laws are about: the cells into which agents divide a region, on the ground, and the convex hull of agents
// that lead, at their heights.
import {BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Group, Mesh, MeshBasicMaterial, Vector3, VertexColors} from "/vendor/three/build/three.module.js";
import {ConvexHull} from "/vendor/three/examples/jsm/math/ConvexHull.js";

import {agentColours, rgb, styleColour} from "../colours.js";

import {cellsOf, hullOf} from "./polygons.js";
import {Ribbons} from "./ribbons.js";

const MOST_CELLS = 500;  // of a region; to compute more takes more than 20 ms for each row
const FLAT = 1e-3;       // part of a hull's extent below which the hull has no volume

/** Triangles of changing number, in colours of their own. */
class Fill extends Mesh {
  constructor(capacity, opacity) {
    const geometry = new BufferGeometry();
    for (const name of ["position", "color"])
      geometry.setAttribute(name, new BufferAttribute(new Float32Array(9 * capacity), 3).setUsage(DynamicDrawUsage));
    super(
        geometry,
        new MeshBasicMaterial(
            {vertexColors: VertexColors, transparent: true, opacity, depthWrite: false, side: DoubleSide}));
    Object.assign(this, {frustumCulled: false, renderOrder: -1});
    this.clear();
  }

  clear() { this.corners = 0; }

  /** Adds the triangle of three points [x, y, z]. */
  add(points, colour) {
    const {position, color} = this.geometry.attributes;
    if (this.corners + 3 > position.count) return;
    for (const point of points) {
      position.setXYZ(this.corners, ...point);
      color.setXYZ(this.corners++, ...colour);
    }
  }

  /** Adds a convex polygon. */
  addPolygon(points, colour) {
    for (let k = 2; k < points.length; ++k) this.add([points[0], points[k - 1], points[k]], colour);
  }

  send() {
    this.geometry.setDrawRange(0, this.corners);
    for (const attribute of Object.values(this.geometry.attributes)) attribute.needsUpdate = true;
  }

  dispose() {
    this.geometry.dispose();
    this.material.dispose();
  }
}

/** Straight lines of changing number. */
class Lines extends Ribbons {
  constructor(capacity) {
    super(capacity);
    this.clear();
  }

  clear() { this.used = 0; }

  add(from, to, colour, alpha, width, dash = 0) {
    if (this.used >= this.capacity) return;
    this.place(this.used, from, 0, to, 0);
    this.paint(this.used, colour, alpha);
    this.shape(this.used++, width, 0, dash);
  }

  /** Adds the sides of a polygon. */
  addPolygon(points, ...look) {
    points.forEach((point, k) => this.add(point, points[(k + 1) % points.length], ...look));
  }

  showAll() {
    this.count = this.used;
    this.send(["start", "end", "tint", "form"]);
  }
}

/** What both layers have in common: lines and fills that are made anew for each row. */
class Areas extends Group {
  constructor(lines, triangles, opacity) {
    super();
    this.lines = new Lines(lines);
    this.fill = new Fill(triangles, opacity);
    this.add(this.fill, this.lines);
  }

  update(frame) {
    if (!this.visible) return;
    this.lines.clear();
    this.fill.clear();
    this.fillIn(frame);
    this.lines.showAll();
    this.fill.send();
  }

  dispose() {
    this.lines.dispose();
    this.fill.dispose();
  }
}

const onGround = ([x, y]) => [x, y, 0];

/** Regions, each with the cells of its agents: {region_m, agents}. */
export class Cells extends Areas {
  #regions;
  #size;

  constructor(regions, size) {
    // The cells of n agents have less than 6 n sides between them, and n + corners along the region.
    const agents = regions.reduce((sum, each) => sum + Math.min(MOST_CELLS, each.agents.length), 0),
          corners = regions.reduce((sum, {region_m}) => sum + region_m.length, 0);
    super(8 * agents + 2 * corners, 8 * agents + corners, 0.12);
    this.#regions = regions;
    this.#size = size;
    this.drawn = [];  // {agent, corners}, as of the last row
  }

  fillIn({p}) {
    const colours = agentColours(this.#size).map(rgb), line = rgb(styleColour("area"));
    this.drawn = [];
    for (const {region_m, agents} of this.#regions) {
      if (agents.length <= MOST_CELLS) {
        const cells = cellsOf(region_m, agents.map((id) => [p[3 * id - 3], p[3 * id - 2]]));
        agents.forEach((agent, k) => this.#add(agent, cells[k], colours[agent - 1], line));
      }
      this.lines.addPolygon(region_m.map(onGround), line, 0.9, 2);
    }
  }

  #add(agent, corners, colour, line) {
    this.drawn.push({agent, corners});
    this.fill.addPolygon(corners.map(onGround), colour);
    this.lines.addPolygon(corners.map(onGround), line, 0.55, 1.2);
  }
}

/** Convex hulls of agents: {agents, axes}; along "xy", heights do not count. */
export class Hulls extends Areas {
  #hulls;

  constructor(hulls) {
    const agents = hulls.reduce((sum, each) => sum + each.agents.length, 0);
    super(3 * agents, 2 * agents, 0.1);  // Euler: 3 n - 6 sides and 2 n - 4 triangles
    this.#hulls = hulls;
    this.drawn = [];  // lists of points [x, y, z], as of the last row
  }

  fillIn({p}) {
    const colour = rgb(styleColour("area"));
    this.drawn = this.#hulls.map(({agents, axes}) => {
      const points = agents.map((id) => p.slice(3 * id - 3, 3 * id));
      const solid = axes === "xyz" ? solidOf(points) : null;
      return solid ? this.#addSolid(solid, colour) : this.#addFlat(points, colour);
    });
  }

  #addFlat(points, colour) {
    const corners = hullOf(points.map(([x, y]) => [x, y])).map((k) => points[k]);
    this.lines.addPolygon(corners, colour, 0.9, 1.8, 6);
    this.fill.addPolygon(corners, colour);
    return corners;
  }

  #addSolid({triangles, sides, corners}, colour) {
    for (const triangle of triangles) this.fill.add(triangle, colour);
    for (const [from, to] of sides) this.lines.add(from, to, colour, 0.9, 1.8, 6);
    return corners;
  }
}

/** The convex hull of points in space: its triangles, the sides where it bends, its corners; null: it is flat. */
function solidOf(points) {
  if (points.length < 4 || isFlat(points)) return null;
  const {faces} = new ConvexHull().setFromPoints(points.map((point) => new Vector3(...point)));
  const triangles = [], sides = [], corners = new Map();
  for (const face of faces) {
    const triangle = [];
    for (let edge = face.edge, k = 0; k < 3; edge = edge.next, ++k) {
      const to = edge.head().point.toArray(), from = edge.tail().point.toArray();
      triangle.push(to);
      if (face.normal.dot(edge.twin.face.normal) > 1 - 1e-6) continue;  // it goes on straight
      corners.set(String(to), to);
      if (String(from) < String(to)) sides.push([from, to]);  // each side has two faces
    }
    triangles.push(triangle);
  }
  return {triangles, sides, corners: [...corners.values()]};
}

/** Whether points lie in a plane, or nearly so. */
function isFlat(points) {
  const [o, ...others] = points.map((point) => new Vector3(...point));
  const ways = others.map((point) => point.sub(o)), extent = Math.max(...ways.map((way) => way.length()));
  const longest = ways.reduce((most, way) => (way.length() > most.length() ? way : most));
  const normal = ways.map((way) => longest.clone().cross(way))
                     .reduce((most, cross) => (cross.length() > most.length() ? cross : most));
  if (normal.length() <= FLAT * extent * extent) return true;
  normal.normalize();
  return ways.every((way) => Math.abs(way.dot(normal)) <= FLAT * extent);
}

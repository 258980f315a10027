// The ground z = 0: a grid whose step is a round number of metres and fits the distance of the camera, the axes x
// (east) and y (north), and their labels in metres.
import {Color, DoubleSide, Mesh, PlaneBufferGeometry, ShaderMaterial} from "/vendor/three/build/three.module.js";

import {styleColour} from "../colours.js";
import {exact} from "../numbers.js";

const VERTEX = `
  varying vec2 vPlace;
  void main() {
    vec4 place = modelMatrix * vec4(position, 1.0);
    vPlace = place.xy;
    gl_Position = projectionMatrix * viewMatrix * place;
  }`;

const FRAGMENT = `
  precision highp float;
  uniform float stepLength, reach;
  uniform vec2 middle;
  uniform vec3 lines, east, north;
  varying vec2 vPlace;
  float on(vec2 place, float step) {
    vec2 x = place / step, width = fwidth(x);
    vec2 near = abs(fract(x - 0.5) - 0.5) / max(width, 1e-6);
    vec2 dense = clamp(1.0 - 3.0 * width, 0.0, 1.0);
    return max((1.0 - min(near.x, 1.0)) * dense.x, (1.0 - min(near.y, 1.0)) * dense.y);
  }
  void main() {
    vec2 toAxis = abs(vPlace) / fwidth(vPlace);
    float fade = 1.0 - smoothstep(0.35, 1.0, distance(vPlace, middle) / reach);
    float alpha = max(0.13 * on(vPlace, stepLength), 0.3 * on(vPlace, 5.0 * stepLength));
    vec2 axis = 0.8 * clamp(1.6 - toAxis, 0.0, 1.0);
    vec3 colour = axis.y > 0.0 || axis.x > 0.0 ? (axis.y > axis.x ? east : north) : lines;
    alpha = max(alpha, max(axis.x, axis.y));
    gl_FragColor = vec4(colour, alpha * fade);
  }`;

export class Ground extends Mesh {
  constructor() {
    super(new PlaneBufferGeometry(2, 2), new ShaderMaterial({
            vertexShader: VERTEX,
            fragmentShader: FRAGMENT,
            transparent: true,
            depthWrite: false,
            side: DoubleSide,
            extensions: {derivatives: true},
            uniforms: {
              stepLength: {value: 1},
              reach: {value: 1},
              middle: {value: [0, 0]},
              lines: {value: new Color()},
              east: {value: new Color()},
              north: {value: new Color()}
            },
          }));
    Object.assign(this, {frustumCulled: false, renderOrder: -2});
    this.step_m = 1;
  }

  paint() {
    const {lines, east, north} = this.material.uniforms;
    lines.value.set(styleColour("grid"));
    east.value.set(styleColour("axis-x"));
    north.value.set(styleColour("axis-y"));
  }

  /** Fits the grid to what the camera looks at. */
  fit(target, distance) {
    this.step_m = roundStep(distance / 16);
    const reach = 3 * distance, {stepLength, reach: limit, middle} = this.material.uniforms;
    this.position.set(target.x, target.y, 0);
    this.scale.set(reach, reach, 1);
    stepLength.value = this.step_m;
    limit.value = reach;
    middle.value = [target.x, target.y];
  }

  /** Places and texts of labels along the axes, one for each bold line near the target. */
  labels(target) {
    const bold = 5 * this.step_m, labels = [];
    for (let k = -6; k <= 6; ++k) {
      const x = bold * (Math.round(target.x / bold) + k), y = bold * (Math.round(target.y / bold) + k);
      if (x !== 0) labels.push([[x, 0, 0], metres(x)]);
      if (y !== 0) labels.push([[0, y, 0], metres(y)]);
    }
    labels.push([[0, 0, 0], "0"]);
    return labels;
  }

  /** Where the names of the axes stand. */
  names() {
    const far = 5 * this.step_m * 1.5;
    return [[[far, 0, 0], "x east", styleColour("axis-x")], [[0, far, 0], "y north", styleColour("axis-y")]];
  }
}

const metres = (x) => `${exact(x)} m`;

// The next of ..., 0.1, 0.2, 1, 2, 10, 20, ...: five times each is a round number, too.
function roundStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return x / power < 2 ? power * 1 : x / power < 6 ? power * 2 : power * 10;
}

// Polygons in x and y, as lists of corners [x, y], counterclockwise: the cells into which agents divide a region, and
// convex hulls.

/** The part of a convex polygon that is at least as near to `p` as to `q`, which is another place. */
function nearer(polygon, p, q) {
  const wx = q[0] - p[0], wy = q[1] - p[1], mx = (p[0] + q[0]) / 2, my = (p[1] + q[1]) / 2;
  const beyond = polygon.map(([x, y]) => (x - mx) * wx + (y - my) * wy), part = [];
  polygon.forEach((a, i) => {
    const next = (i + 1) % polygon.length, b = polygon[next];
    if (beyond[i] <= 0) part.push(a);
    if (beyond[i] * beyond[next] < 0) {
      const share = beyond[i] / (beyond[i] - beyond[next]);
      part.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
    }
  });
  return part;
}

const farthest = (polygon, [px, py]) => polygon.reduce((most, [x, y]) => Math.max(most, Math.hypot(x - px, y - py)), 0);

/**
 * For each of the places [x, y], the part of a convex region that is nearest to it: its Voronoi cell. Of places that
 * are equal, the first has the cell. Neighbours are looked at from the nearest in x on, until none can cut the cell.
 */
export function cellsOf(region, places) {
  const order = places.map((_, k) => k).sort((a, b) => places[a][0] - places[b][0] || a - b), cells = [];
  order.forEach((k, at) => {
    const p = places[k];
    let cell = region, reach = 2 * farthest(cell, p);
    const cut = (other) => {
      const q = places[other];
      if (q[0] === p[0] && q[1] === p[1])
        cell = other < k ? [] : cell;
      else if (Math.hypot(q[0] - p[0], q[1] - p[1]) < reach)
        cell = nearer(cell, p, q);
      else
        return;
      reach = 2 * farthest(cell, p);
    };
    for (let left = at - 1, right = at + 1; left >= 0 || right < order.length;) {
      const toLeft = left >= 0 ? p[0] - places[order[left]][0] : Infinity,
            toRight = right < order.length ? places[order[right]][0] - p[0] : Infinity;
      if (Math.min(toLeft, toRight) > reach) break;
      cut(order[toLeft < toRight ? left-- : right++]);
    }
    cells[k] = cell;
  });
  return cells;
}

/** Indices of those of the points [x, y] that are the corners of their convex hull (Andrew's monotone chain). */
export function hullOf(points) {
  const order =
      points.map((_, k) => k).sort((a, b) => points[a][0] - points[b][0] || points[a][1] - points[b][1] || a - b);
  const isNew = (k, at) => at === 0 || String(points[k]) !== String(points[order[at - 1]]), apart = order.filter(isNew);
  const turnsLeft = (a, b, c) => (points[b][0] - points[a][0]) * (points[c][1] - points[a][1]) >
      (points[b][1] - points[a][1]) * (points[c][0] - points[a][0]);
  const half = (indices) => {
    const kept = [];
    for (const k of indices) {
      while (kept.length > 1 && !turnsLeft(kept.at(-2), kept.at(-1), k)) kept.pop();
      kept.push(k);
    }
    return kept.slice(0, -1);
  };
  const corners = [...half(apart), ...half(apart.toReversed())];
  return corners.length > 0 ? corners : apart;
}

function a = control(t, me, neighbours, params)
  % Consensus: go where the neighbours are, and as fast as they are.
  a = zeros(3, 1);
  for j = neighbours
    a = a + j.weight * (params.p_gain * (j.position - me.position) + params.v_gain * (j.velocity - me.velocity));
  end
end

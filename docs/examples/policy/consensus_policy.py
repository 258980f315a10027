#!/usr/bin/python3
"""Writes a policy for law.name = "policy" by hand: the consensus law as a network of the format ONNX.

  docs/examples/policy/consensus_policy.py PLACES HASH FILE

PLACES is how many agents an agent may hear, HASH that of the observation's layout; `orchestrator check` names both.
configs/policy.onnx is of 3 places. The network does not mind in which order neighbours stand:

  a = p_gain sum_j a_ij (p_j - p_i) - beta v
"""

import sys

import numpy as np
from onnx import TensorProto, checker, helper, numpy_helper

OWN, OF_NEIGHBOUR = 10, 9  # numbers: own p 3, v 3, attitude 4; of each neighbour p 3, v 3, weight, heard, age
P_GAIN, BETA = 3 / 64, 29 / 32  # numbers that a float32 has


def network(places):
    constants = []

    def constant(name, values, kind):
        constants.append(numpy_helper.from_array(np.array(values, dtype=kind), name))
        return name

    def integers(name, *values):
        return constant(name, values, np.int64)

    row, neighbours = integers("axis_of_row", 1), integers("axis_of_neighbours", 0)
    nodes = [
        helper.make_node("Slice", ["observation", integers("v_first", 3), integers("v_end", 6), row], ["v"]),
        helper.make_node("Slice", ["observation", integers("heard_first", OWN),
                                   integers("heard_end", OWN + OF_NEIGHBOUR * places), row], ["heard"]),
        helper.make_node("Reshape", ["heard", integers("table", places, OF_NEIGHBOUR)], ["neighbours"]),
        helper.make_node("Slice", ["neighbours", integers("p_first", 0), integers("p_end", 3), row], ["away"]),
        helper.make_node("Slice", ["neighbours", integers("weight_first", 6), integers("weight_end", 7), row],
                         ["weights"]),
        helper.make_node("Mul", ["away", "weights"], ["pulls"]),
        helper.make_node("ReduceSum", ["pulls", neighbours], ["pull"], keepdims=1),
        helper.make_node("Mul", ["pull", constant("p_gain", [P_GAIN], np.float32)], ["towards"]),
        helper.make_node("Mul", ["v", constant("beta", [BETA], np.float32)], ["damping"]),
        helper.make_node("Sub", ["towards", "damping"], ["acceleration"]),
    ]
    observation = helper.make_tensor_value_info("observation", TensorProto.FLOAT, [1, OWN + OF_NEIGHBOUR * places])
    acceleration = helper.make_tensor_value_info("acceleration", TensorProto.FLOAT, [1, 3])
    return helper.make_graph(nodes, "consensus", [observation], [acceleration], constants)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    model = helper.make_model(network(int(sys.argv[1])), opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    helper.set_model_props(model, {"mascot_observation": sys.argv[2]})
    checker.check_model(model)
    with open(sys.argv[3], "wb") as file:
        file.write(model.SerializeToString(deterministic=True))


if __name__ == "__main__":
    main()

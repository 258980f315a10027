def control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader):
    return -vel_x[i], -vel_y[i]

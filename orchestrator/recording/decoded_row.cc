#include "orchestrator/recording/decoded_row.h"

#include "bus/wire.h"

namespace mascot {

void DecodedRow::Take(const Row& row) {
  mascot_msgs::msg::AgentState state;
  mascot_msgs::msg::AgentCommand command;
  mascot_msgs::msg::AgentMessage message;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Deserialize(row.states[i], state);
    motions[i] = FromWire(state);
    messages[i].clear();
    if (!row.messages[i].empty()) {
      Deserialize(row.messages[i], message);
      messages[i].assign(message.data().begin(), message.data().end());
    }
    if (row.commands[i].empty()) continue;  // held
    Deserialize(row.commands[i], command);
    commands[i] = FromWire(command);
  }
}

}  // namespace mascot

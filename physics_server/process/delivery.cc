#include "physics_server/process/delivery.h"

#include <utility>

#include "physics_server/process/bundled_delivery.h"
#include "physics_server/process/topic_delivery.h"

namespace mascot {

std::unique_ptr<Delivery> MakeDelivery(Domain& domain, const Experiment& experiment, Delivery::OnAnswers on_answers) {
  if (experiment.network.is_bundled())
    return std::make_unique<BundledDelivery>(domain, experiment, std::move(on_answers));
  return std::make_unique<TopicDelivery>(domain, experiment, on_answers);
}

}  // namespace mascot

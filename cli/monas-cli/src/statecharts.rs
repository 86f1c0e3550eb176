//! Links the generated statecharts, which register themselves. Kept in step by `monas generate`.

use attacker as _;
use extended_attacker as _;
use goalie as _;

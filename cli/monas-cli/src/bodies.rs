//! Links the bodies, which register themselves. Kept in step by `cargo xtask bodies`.

use monas_nao as _;
use monas_rcsssmj as _;

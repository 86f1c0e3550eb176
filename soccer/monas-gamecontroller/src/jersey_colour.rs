//! Colours of jerseys.

use monas_robot::Colour;

use crate::rule_book::codes;

codes! {
    /// The colour of a team's or goalkeeper's jersey.
    JerseyColour, "colour":
    /// Blue.
    Blue "blue" Some(0), Some(0);
    /// Red.
    Red "red" Some(1), Some(1);
    /// Yellow.
    Yellow "yellow" Some(2), Some(2);
    /// Black.
    Black "black" Some(3), Some(3);
    /// White.
    White "white" Some(4), Some(4);
    /// Green.
    Green "green" Some(5), Some(5);
    /// Orange.
    Orange "orange" Some(6), Some(6);
    /// Purple.
    Purple "purple" Some(7), Some(7);
    /// Brown.
    Brown "brown" Some(8), Some(8);
    /// Gray.
    Gray "gray" Some(9), Some(9);
}

impl From<JerseyColour> for Colour {
    fn from(colour: JerseyColour) -> Colour {
        match colour {
            JerseyColour::Blue => Colour::Blue,
            JerseyColour::Red => Colour::Red,
            JerseyColour::Yellow => Colour::Yellow,
            JerseyColour::Black => Colour::Black,
            JerseyColour::White => Colour::White,
            JerseyColour::Green => Colour::Green,
            JerseyColour::Orange => Colour::Orange,
            JerseyColour::Purple => Colour::Purple,
            JerseyColour::Brown => Colour::Brown,
            JerseyColour::Gray => Colour::Gray,
        }
    }
}

//! The states.

use ::yase_codegen::typed::NodeId;

/// The nodes of the chart, in its order. Each is named by the shortest unique end of its path.
#[allow(non_camel_case_types, clippy::upper_case_acronyms)] // names as in the model
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum State {
    /// OR: `patrol`
    patrol,
    /// START: `patrol/START`
    START__of__patrol,
    /// AND: `patrol/(walk.type.[2nd])~||watch+`
    __open__walk__then__type__then____opt__2nd__end____close____ever____par__watch__more__,
    /// END: `patrol/END`
    END__of__patrol,
    /// OR: `patrol/(walk.type.[2nd])~||watch+/1`
    region1,
    /// START: `patrol/(walk.type.[2nd])~||watch+/1/START`
    START__of__region1,
    /// OR: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~`
    __open__walk__then__type__then____opt__2nd__end____close____ever__,
    /// END: `patrol/(walk.type.[2nd])~||watch+/1/END`
    END__of__region1,
    /// OR: `patrol/(walk.type.[2nd])~||watch+/2`
    region2,
    /// START: `patrol/(walk.type.[2nd])~||watch+/2/START`
    START__of__region2,
    /// OR: `patrol/(walk.type.[2nd])~||watch+/2/watch+`
    watch__more__,
    /// END: `patrol/(walk.type.[2nd])~||watch+/2/END`
    END__of__region2,
    /// START: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/START`
    START__of____open__walk__then__type__then____opt__2nd__end____close____ever__,
    /// OR: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])`
    __open__walk__then__type__then____opt__2nd__end____close__,
    /// START: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/START`
    START__of____open__walk__then__type__then____opt__2nd__end____close__,
    /// BASIC: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/walk`
    walk,
    /// BASIC: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/type`
    __u74__ype,
    /// OR: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/[2nd]`
    __opt__2nd__end__,
    /// END: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/END`
    END__of____open__walk__then__type__then____opt__2nd__end____close__,
    /// START: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/[2nd]/START`
    START__of____opt__2nd__end__,
    /// CONDITION: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/[2nd]/CONDITION`
    CONDITION,
    /// BASIC: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/[2nd]/2nd`
    __u32__nd,
    /// END: `patrol/(walk.type.[2nd])~||watch+/1/(walk.type.[2nd])~/(walk.type.[2nd])/[2nd]/END`
    END__of____opt__2nd__end__,
    /// START: `patrol/(walk.type.[2nd])~||watch+/2/watch+/START`
    START__of__watch__more__,
    /// BASIC: `patrol/(walk.type.[2nd])~||watch+/2/watch+/watch`
    watch,
    /// END: `patrol/(walk.type.[2nd])~||watch+/2/watch+/END`
    END__of__watch__more__,
}

impl From<State> for NodeId {
    fn from(state: State) -> NodeId {
        NodeId(state as u32)
    }
}

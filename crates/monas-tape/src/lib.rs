//! Records everything published into MCAP files, with protobuf schemas

ByteAddressBuffer zeros : register(t0); // another list
